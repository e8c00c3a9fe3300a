// The `mapweld` command as scripts see it: exit codes, standard output, standard error. Ended as a program.
#include <regex>

#include "tests/client/command/command_fixture.h"
#include "tests/client/drawing/well_formed.h"

namespace mapweld {
namespace {

using contract::Json;
using mapweld::testing::Ended;
using mapweld::testing::FakeServer;
using mapweld::testing::TemporaryFolder;
using Command = mapweld::testing::CommandFixture;

Json merge_json(const std::string& state, double elapsed_s = 1.5, int edges = 247) {
  Json merge = Json::parse(R"({"id":1,"state":"","method":"quickconnect","maps":["lab-a","lab-b"],"map":"lab","seed":0,
    "phase":"exploration","step":1,"words":{"done":9120,"total":31877},
    "candidates":{"known":5120,"verified":412,"accepted":247},"edges":0,"components":3,"algebraic_connectivity":0.0,
    "largest_component":{"vertices":1960,"algebraic_connectivity":0.0131},"joined":[],"elapsed_s":0.0,
    "budget":{"seconds":1.5},"stop_reason":null,"error":null})");
  merge["state"] = state;
  merge["elapsed_s"] = elapsed_s;
  merge["edges"] = edges;
  merge["edge_counts"] = {{"verified", edges}, {"confirmed", edges / 2}};
  return merge;
}

Json localization(const std::string& status) {
  Json answer = Json::parse(R"({"status":"","reason":null,"took_ms":23.1,
    "funnel":{"features":455,"known_words":301,"candidates":37,"verified":9,"best_inliers":61,"needed_inliers":12},
    "matches":[{"vertex":812,"map":"lab-a","member_vertex":812,"name":"000812.jpg","votes":143,"inliers":61,
                "verified":true}]})");
  answer["status"] = status;
  if (status == "not_found") {
    answer["matches"] = Json::array();
    answer["reason"] = "too_few_inliers";
  }
  return answer;
}

TEST_F(Command, UsageErrorsAreTwo) {
  for (const char* arguments : {"",
                                "fly",
                                "map",
                                "map create",
                                "map show a b",
                                "merge lab-a",
                                "merge a b --budget 0s",
                                "merge a b --budget soon",
                                "merge a b --budget -1s",
                                "merge a b --budget-edges 0",
                                "merge a b --budget-fraction 1.5",
                                "merge a b --votes sum",
                                "merge a b --method fast",
                                "merge a b --watch --wait",
                                "upload lab /nowhere/at/all",
                                "upload lab . --threads 0",
                                "upload lab . --batch 65",
                                "localize lab /nowhere.jpg",
                                "localize lab",
                                "graph lab --format png",
                                "merges show x",
                                "merges fly",
                                "--server ftp://x map list",
                                "map create lab --label nonsense",
                                "merges curve 1 --format png",
                                "explain 1 2",
                                "explain 1 2 x",
                                "explain -1 2 3",
                                "explain lab 2 -3",
                                "explain 1 2 3 --out pair.gif"}) {
    const Ended ended = ask(arguments);
    EXPECT_EQ(ended.code, 2) << arguments << "\n" << ended.err;
    EXPECT_EQ(ended.out, "") << arguments;
    EXPECT_NE(ended.err, "") << arguments;
  }
  EXPECT_TRUE(server.requests().empty());
}

TEST_F(Command, HelpAndVersionAreZero) {
  EXPECT_EQ(run("--version").out.substr(0, 8), "mapweld ");
  for (const char* arguments : {"--help", "map --help", "upload --help", "merge --help", "merges resume --help"}) {
    const Ended help = run(arguments);
    EXPECT_EQ(help.code, 0) << arguments;
    EXPECT_NE(help.out.find("Usage:"), std::string::npos) << arguments;
  }
  EXPECT_NE(run("--help").out.find("Exit codes:"), std::string::npos);
}

TEST_F(Command, NoConnectionIsThree) {
  const std::string nowhere = FakeServer().url();
  const Ended refused = run("--server " + nowhere + " map list");
  EXPECT_EQ(refused.code, 3);
  EXPECT_NE(refused.err.find("Is mapweld-server running?"), std::string::npos) << refused.err;
  EXPECT_EQ(run("map list", "MAPWELD_SERVER=" + nowhere).code, 3);
}

TEST_F(Command, ServerProblemIsOneAndPrinted) {
  server.script_problem("GET /v1/maps/lab", "no_such_map", "There is no map \"lab\".");
  const Ended ended = ask("map show lab");
  EXPECT_EQ(ended.code, 1);
  EXPECT_EQ(ended.out, "");
  EXPECT_EQ(ended.err, "mapweld: There is no map \"lab\". (no_such_map, HTTP 404, request r1)\n");
  const Ended json = ask("map show lab --json");
  EXPECT_EQ(json.code, 1);
  EXPECT_EQ(Json::parse(json.out)["code"], "no_such_map");
}

TEST_F(Command, AKeyGoesWithEveryRequestAndNowhereElse) {
  const std::string there = "--server " + server.url() + " ";
  server.script("GET /v1/maps", 200, Json{{"items", Json::array()}, {"next_cursor", nullptr}});
  EXPECT_EQ(run(there + "map list").code, 0);
  EXPECT_EQ(run(there + "map list", "MAPWELD_KEY=mw_one").code, 0);
  EXPECT_EQ(run(there + "map list --key mw_two", "MAPWELD_KEY=mw_one").code, 0);
  EXPECT_EQ(server.authorizations(), (std::vector<std::string>{"", "Bearer mw_one", "Bearer mw_two"}));
  for (const std::string& request : server.requests()) EXPECT_EQ(request.find("mw_"), std::string::npos) << request;
  const Ended broken = run(there + "--key 'mw one' map list");
  EXPECT_EQ(broken.code, 2);
  EXPECT_EQ(broken.err.find("mw one"), std::string::npos) << broken.err;
  EXPECT_EQ(run("--server http://mw_one@127.0.0.1 map list").code, 2);
}

TEST_F(Command, ARefusedKeySaysWhatToDo) {
  server.script_problem("GET /v1/maps", "unauthorized", "This server asks for a key.");
  const Ended without = ask("map list");
  EXPECT_EQ(without.code, 1);
  EXPECT_NE(without.err.find("Give a key: MAPWELD_KEY"), std::string::npos) << without.err;
  const Ended wrong = ask("--key mw_old map list");
  EXPECT_NE(wrong.err.find("does not take the key"), std::string::npos) << wrong.err;
  server.script("GET /healthz", 200, Json{{"status", "ok"}});
  server.script_problem("GET /version", "unauthorized", "This server asks for a key.");
  const Ended health = ask("health");
  EXPECT_EQ(health.code, 0);
  EXPECT_NE(health.out.find("asks for a key"), std::string::npos) << health.out;
}

TEST_F(Command, ControlCharactersFromTheServerDoNotReachTheTerminal) {
  server.script_problem("GET /v1/maps/lab", "no_such_map", "\x1b[2Jgone\n");
  EXPECT_EQ(ask("map show lab").err.find('\x1b'), std::string::npos);
}

TEST_F(Command, MapsAreMadeListedAndDeleted) {
  const std::string map = R"({"name":"lab","kind":"map","vocabulary":"indoor-50k","vertices":3,"edges":2,)"
                          R"("edge_counts":{"verified":4,"confirmed":2},"ignored":1,)"
                          R"("parameters":{"min_votes":12},"extra":7})";
  server.script("POST /v1/maps", 201, map);
  server.script("GET /v1/maps", 200, R"({"items":[)" + map + R"(],"next_cursor":null})");
  server.script("DELETE /v1/maps/lab", 204, std::string());
  const Ended made = ask("map create lab --min-votes 12 --label robot=p3at-1 --json");
  EXPECT_EQ(made.code, 0);
  EXPECT_EQ(made.out, map + "\n");  // exactly what the server said, unknown fields too
  server.script("GET /v1/maps/lab", 200, map);
  EXPECT_EQ(ask("map show lab").out.find("static"), std::string::npos);
  server.script("GET /v1/maps/lab", 200, std::string(R"({"name":"lab","static_share":0.115})"));
  EXPECT_NE(ask("map show lab").out.find("12 % of an image, the same in all of them, is left out"), std::string::npos);
  const Ended list = ask("map list");
  EXPECT_TRUE(std::regex_search(list.out, std::regex("lab +map +3 +2 +4 +1 +indoor-50k"))) << list.out;
  const Ended gone = ask("map delete lab");
  EXPECT_EQ(gone.code, 0);
  EXPECT_EQ(gone.out, "Map lab is gone.\n");
  EXPECT_EQ(server.requests().back(), "DELETE /v1/maps/lab");
}

TEST_F(Command, MasksAreSetShownAndCleared) {
  const std::string map =
      R"({"name":"lab","mask":{"width_px":640,"height_px":480,"used_share":0.817,"sha256":"ab"},"extra":7})";
  server.script("PUT /v1/maps/lab/mask", 204, std::string());
  server.script("GET /v1/maps/lab", 200, map);
  server.script("GET /v1/maps/lab/mask", 200, std::string("png bytes"));
  server.script("DELETE /v1/maps/lab/mask", 204, std::string());
  folder.write("mask.png", "\x89PNG mask");
  const Ended set = ask("mask set lab " + in_folder("mask.png"));
  EXPECT_EQ(set.code, 0);
  EXPECT_EQ(set.out,
            "Map lab has a mask of 640x480 pixels, which uses 82 % of an image.\n"
            "It counts for what is uploaded or localized from now on.\n");
  EXPECT_EQ(server.requests().front(), "PUT /v1/maps/lab/mask");
  EXPECT_EQ(server.bodies().front(), "\x89PNG mask");
  EXPECT_EQ(ask("mask show lab --json").out, map + "\n");
  EXPECT_EQ(ask("mask show lab --out " + in_folder("copy.png")).code, 0);
  EXPECT_EQ(client::read_file(folder.path() / "copy.png"), "png bytes");
  EXPECT_EQ(ask("mask clear lab").out, "Map lab has no mask any more.\n");
  EXPECT_EQ(server.requests().back(), "DELETE /v1/maps/lab/mask");
  server.script("GET /v1/maps/lab", 200, std::string(R"({"name":"lab"})"));
  EXPECT_EQ(ask("mask show lab").out, "Map lab has no mask: every pixel of its images is used.\n");
  EXPECT_EQ(ask("mask set lab " + in_folder("nothing.png")).code, 2);
}

TEST_F(Command, UploadSaysWhatBecameOfTheFolder) {
  std::filesystem::create_directory(folder.path() / "images");
  for (const char* name : {"images/a.jpg", "images/b.jpg"}) folder.write(name, std::string("image ") + name);
  const Ended first = ask("upload lab " + in_folder("images"));
  EXPECT_EQ(first.code, 0) << first.err;
  EXPECT_NE(first.out.find("2 inserted, 0 ignored as too similar"), std::string::npos) << first.out;
  EXPECT_NE(first.err.find("2 of 2 images"), std::string::npos) << first.err;

  folder.write("images/c.jpg", "bad image");
  const Ended again = ask("upload lab " + in_folder("images") + " --json --threads 8 --batch 1");
  EXPECT_EQ(again.code, 5);
  const Json json = Json::parse(again.out);
  EXPECT_EQ(json["skipped"], 2);
  EXPECT_EQ(json["refused"], 1);
  EXPECT_EQ(json["items"][0]["code"], "undecodable_image");
  EXPECT_EQ(json["items"][0]["name"], "c.jpg");
  EXPECT_NE(again.err.find("c.jpg: The image is truncated. (undecodable_image)"), std::string::npos) << again.err;

  std::filesystem::create_directory(folder.path() / "empty");
  EXPECT_EQ(ask("upload lab " + in_folder("empty")).code, 2);
}

TEST_F(Command, LocalizeIsFourUnlessEveryImageIsFound) {
  folder.write("a.jpg", "a");
  folder.write("b.jpg", "b");
  const std::string files = in_folder("a.jpg") + " " + in_folder("b.jpg");
  server.script("POST /v1/maps/lab/localize", 200, localization("localized"));
  const Ended found = ask("localize lab " + files);
  EXPECT_EQ(found.code, 0);
  EXPECT_TRUE(std::regex_search(found.out, std::regex("a.jpg +localized +000812.jpg of lab-a +812 +143 +61")))
      << found.out;
  EXPECT_NE(found.out.find("2 of 2 images localized in lab."), std::string::npos);

  server.script_sequence("POST /v1/maps/lab/localize", {localization("localized"), localization("not_found")});
  const Ended half = ask("localize lab " + files);
  EXPECT_EQ(half.code, 4);
  EXPECT_NE(
      half.out.find("not found  too_few_inliers: 455 features, 301 known words, 37 candidates, 9 verified, best 61 "
                    "of 12 inliers needed"),
      std::string::npos)
      << half.out;

  server.script("POST /v1/maps/lab/localize", 200, localization("ambiguous"));
  const Ended doubt = ask("localize lab --json " + in_folder("a.jpg"));
  EXPECT_EQ(doubt.code, 4);
  EXPECT_EQ(doubt.out, contract::dump(localization("ambiguous")) + "\n");

  server.script_problem("POST /v1/maps/lab/localize", "undecodable_image", "The image is truncated.");
  EXPECT_EQ(ask("localize lab " + in_folder("a.jpg")).code, 1);
  EXPECT_EQ(ask("localize lab " + files).code, 5);
  server.script_problem("POST /v1/maps/lab/localize", "no_such_map", "There is no map \"lab\".");
  EXPECT_EQ(ask("localize lab " + files).code, 1);
}

TEST_F(Command, MergeIsSubmittedAsItWasAsked) {
  server.script("POST /v1/merges", 202, merge_json("queued"));
  const Ended ended = ask("merge lab-a lab-b");
  EXPECT_EQ(ended.code, 0);
  EXPECT_NE(ended.out.find("mapweld merges watch 1"), std::string::npos);
  EXPECT_EQ(server.bodies().back(), R"({"maps":["lab-a","lab-b"]})");
  ask("merge lab-a lab-b lab-c --name lab --method brute-force --seed 7 --votes product --min-votes 15 --budget 500ms "
      "--budget-verifications 100 --budget-edges 9 --budget-fraction 0.9 --certified");
  EXPECT_EQ(server.bodies().back(),
            R"({"maps":["lab-a","lab-b","lab-c"],"name":"lab","method":"brute-force","seed":7,)"
            R"("parameters":{"min_votes":15,"votes":"product"},)"
            R"("budget":{"seconds":0.5,"verifications":100,"edges":9,"fraction_of_maximum":0.9,"certified":true}})");
  ask("merge lab-a lab-b --alias-guard");
  EXPECT_EQ(server.bodies().back(), R"({"maps":["lab-a","lab-b"],"parameters":{"alias_guard":true}})");
  ask("merge lab-a lab-b --no-alias-guard");
  EXPECT_EQ(server.bodies().back(), R"({"maps":["lab-a","lab-b"],"parameters":{"alias_guard":false}})");
  for (const auto& [text, seconds] : {std::pair("1.5s", "1.5"), std::pair("2m", "120.0"), std::pair("1h", "3600.0"),
                                      std::pair("3", "3.0"), std::pair("2min", "120.0")}) {
    ask(std::string("merge lab-a lab-b --budget ") + text);
    EXPECT_EQ(server.bodies().back(),
              std::string(R"({"maps":["lab-a","lab-b"],"budget":{"seconds":)") + seconds + "}}");
  }
}

TEST_F(Command, WatchingEndsWithTheMerge) {
  server.script("POST /v1/merges", 202, merge_json("queued"));
  const auto ends_in = [&](const std::string& state, const std::string& how) {
    server.script_sequence("GET /v1/merges/1", {merge_json("running", 0.5, 100), merge_json(state)});
    return ask("merge lab-a lab-b " + how);
  };
  const Ended done = ends_in("budget_exhausted", "--watch");
  EXPECT_EQ(done.code, 0) << done.err;
  EXPECT_TRUE(std::regex_search(
      done.out, std::regex("0.50 s +exploration +edges 50 confirmed, 100 verified +connectivity 0.0131")))
      << done.out;
  EXPECT_NE(
      done.out.find(
          "Merge 1 has used up its budget after 1.50 s: between the maps are 123 confirmed edges (of 247 verified)."),
      std::string::npos)
      << done.out;
  EXPECT_EQ(done.out.find('\x1b'), std::string::npos);
  EXPECT_EQ(done.out.find("revoked"), std::string::npos);
  contract::Json revoking = merge_json("running", 0.5, 100), revoked = merge_json("completed");
  revoking["revoked"] = 1;
  revoked["revoked"] = 2;
  server.script_sequence("GET /v1/merges/1", {revoking, revoked});
  const std::string told = ask("merge lab-a lab-b --watch").out;
  EXPECT_NE(told.find("edges 50 confirmed, 100 verified, 1 confirmation revoked  connectivity"), std::string::npos)
      << told;
  EXPECT_NE(told.find("123 confirmed edges (of 247 verified, 2 confirmations revoked)."), std::string::npos) << told;
  EXPECT_EQ(ends_in("completed", "--watch").code, 0);
  EXPECT_EQ(ends_in("failed", "--watch").code, 6);
  EXPECT_EQ(ends_in("cancelled", "--wait").code, 6);
  const Ended json = ends_in("completed", "--watch --json");
  EXPECT_EQ(json.out,
            contract::dump(merge_json("running", 0.5, 100)) + "\n" + contract::dump(merge_json("completed")) + "\n");
  const Ended wait = ends_in("completed", "--wait --json");
  EXPECT_EQ(wait.out, contract::dump(merge_json("completed")) + "\n");
}

TEST_F(Command, MergesAreListedByDefaultAndActedOnByNumber) {
  const Json merges = {{"items", {merge_json("paused")}}, {"next_cursor", nullptr}};
  server.script("GET /v1/merges", 200, merges);
  for (const char* arguments : {"merges", "merges list", "merges list --state paused"}) {
    const Ended list = ask(arguments);
    EXPECT_EQ(list.code, 0) << list.err;
    EXPECT_TRUE(
        std::regex_search(list.out, std::regex(R"(1 +paused +exploration +quickconnect +lab-a \+ lab-b -> lab)")))
        << list.out;
  }
  EXPECT_EQ(Json::parse(ask("merges --json").out), merges);
  for (const char* verb : {"pause", "resume", "restart", "cancel"}) {
    server.script(std::string("POST /v1/merges/1/") + verb, 202, merge_json("running"));
    EXPECT_EQ(ask(std::string("merges ") + verb + " 1").code, 0);
    EXPECT_EQ(server.requests().back(), std::string("POST /v1/merges/1/") + verb);
  }
  ask("merges resume 1 --budget 2s");
  EXPECT_EQ(server.bodies().back(), R"({"budget":{"seconds":2.0}})");
  ask("merges restart 1 --budget-verifications 7");
  EXPECT_EQ(server.requests().back(), "POST /v1/merges/1/restart");
  EXPECT_EQ(server.bodies().back(), R"({"budget":{"verifications":7}})");
  server.script_problem("POST /v1/merges/1/resume", "nothing_to_resume", "Merge 1 is complete.");
  EXPECT_EQ(ask("merges resume 1").code, 1);
  server.script("GET /v1/merges/1", 200, merge_json("completed"));
  EXPECT_NE(ask("merges show 1").out.find("412 of 5120 verified, 247 passed"), std::string::npos);
  EXPECT_EQ(ask("merges watch 1").code, 0);
  server.script("DELETE /v1/merges/1", 204, std::string());
  EXPECT_EQ(ask("merges delete 1").code, 0);
}

TEST_F(Command, FiguresAndExportsGoToFilesWholeOrNotAtAll) {
  server.script("GET /v1/merges/1", 200, merge_json("completed"));
  server.script("GET /v1/merges/1/curve", 200,
                std::string(R"({"items":[{"step":1,"elapsed_s":0.5,"verifications":3,"edges":2,
                  "edge_counts":{"verified":2,"confirmed":1},"components":4,
                  "algebraic_connectivity":0.0,"largest_component":{"vertices":9,"algebraic_connectivity":0.25},
                  "certified_fraction":null,"phase":"exploration"}],"next_cursor":null})"));
  EXPECT_EQ(ask("merges curve 1 --format svg --out " + in_folder("curve.svg")).code, 0);
  EXPECT_EQ(mapweld::testing::xml_fault(client::read_file(folder.path() / "curve.svg")), "");
  const Ended csv = ask("merges curve 1");
  EXPECT_NE(csv.out.find("\n1,0.5,3,2,4,0.0,9,0.25,,exploration,1\n"), std::string::npos) << csv.out;

  server.script("GET /v1/maps/lab/graph", 200,
                std::string(R"({"vertices":[{"vertex":0,"map":"a"},{"vertex":1,"map":"b"}],
                                "edges":[{"u":0,"v":1,"kind":"inter","confirmed":true}]})"));
  EXPECT_EQ(ask("graph lab --out " + in_folder("graph.svg")).code, 0);
  const std::string svg = client::read_file(folder.path() / "graph.svg");
  EXPECT_EQ(mapweld::testing::xml_fault(svg), "");
  EXPECT_EQ(mapweld::testing::count_elements(mapweld::testing::element_of_class(svg, "vertices"), "circle"), 2U);
  EXPECT_EQ(ask("graph lab --format dot").out.front(), '{');  // whatever the server sends is handed on
  EXPECT_EQ(server.requests().back(), "GET /v1/maps/lab/graph?format=dot");

  folder.write("kept.svg", "old");
  server.script_problem("GET /v1/maps/none/graph", "no_such_map", "There is no map \"none\".");
  EXPECT_EQ(ask("graph none --out " + in_folder("kept.svg")).code, 1);
  EXPECT_EQ(ask("graph none --format graphml --out " + in_folder("kept.svg")).code, 1);
  EXPECT_EQ(client::read_file(folder.path() / "kept.svg"), "old");
  EXPECT_EQ(ask("graph lab --out /nowhere/graph.svg").code, 2);
  std::size_t files = 0;
  for (const auto& entry : std::filesystem::directory_iterator(folder.path())) {
    EXPECT_EQ(entry.path().string().find(".part"), std::string::npos) << entry.path();
    ++files;
  }
  EXPECT_EQ(files, 5U);  // curve.svg, graph.svg, kept.svg, out.txt, err.txt
}

TEST_F(Command, HealthQualityAndVocabularies) {
  server.script("GET /healthz", 200, std::string(R"({"status":"ok"})"));
  server.script("GET /version", 200, std::string(R"({"version":"0.1.0"})"));
  server.script("GET /v1/maps/lab/quality", 200, std::string(R"({"vertices":1966,"edges":9121,
                  "edge_counts":{"verified":9240,"confirmed":9121},"components":3,"algebraic_connectivity":0.0,
                  "weighted_algebraic_connectivity":0.0,
                  "largest_component":{"vertices":1960,"algebraic_connectivity":0.0131},"min_degree":0,
                  "edge_connectivity":0,"joined":[{"map":"lab-a","vertices":320}],"independent_joins":288})"));
  server.script("GET /v1/vocabularies", 200,
                std::string(R"({"items":[{"name":"indoor-50k","words":50000,"dimension":128,"descriptor":"sift",
                  "sha256":"ab","index":"hnsw","created_at":"2026-11-23T10:00:00Z"}],"next_cursor":null})"));
  EXPECT_NE(ask("health").out.find("mapweld-server 0.1.0"), std::string::npos);
  const Ended quality = ask("quality lab");
  EXPECT_NE(quality.out.find("1960 vertices, algebraic connectivity 0.0131"), std::string::npos) << quality.out;
  EXPECT_NE(quality.out.find("9121 confirmed, of 9240 verified"), std::string::npos) << quality.out;
  EXPECT_NE(ask("vocabularies").out.find("indoor-50k"), std::string::npos);
  EXPECT_EQ(Json::parse(ask("quality lab --json").out)["independent_joins"], 288);
}

}  // namespace
}  // namespace mapweld
