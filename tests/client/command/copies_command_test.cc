// `mapweld map export`, `import` and `change`, `mapweld images` and `mapweld backup`.
#include <filesystem>
#include <fstream>

#include "tests/client/command/command_fixture.h"

namespace mapweld {
namespace {

using contract::Json;
using mapweld::testing::Ended;
using Copies = mapweld::testing::CommandFixture;

TEST_F(Copies, AMapGoesIntoAFileAndOutOfIt) {
  server.script("GET /v1/maps/lab-a/export", 200, std::string("the bytes"));
  const Ended out = ask("map export lab-a " + in_folder("a.mapweld"));
  EXPECT_EQ(out.code, 0) << out.err;
  EXPECT_NE(out.out.find("9 bytes"), std::string::npos) << out.out;
  EXPECT_EQ(client::read_file((folder.path() / "a.mapweld").string()), "the bytes");
  EXPECT_EQ(ask("map export --no-images lab-a -").out, "the bytes");
  EXPECT_EQ(server.requests()[1], "GET /v1/maps/lab-a/export?images=false");

  server.script("POST /v1/maps:import", 201,
                Json{{"name", "b"}, {"vocabulary", "words"}, {"vertices", 1}, {"edges", 3}});
  const Ended in = ask("map import --name b " + in_folder("a.mapweld"));
  EXPECT_EQ(in.code, 0) << in.err;
  EXPECT_NE(in.out.find("Map b is there: 1 vertex, 3 edges"), std::string::npos) << in.out;
  EXPECT_EQ(server.requests().back(), "POST /v1/maps:import?name=b");
  EXPECT_EQ(server.bodies().back(), "the bytes");
}

TEST_F(Copies, ImagesAreDeletedAndRestored) {
  server.script("DELETE /v1/maps/a/vertices/3", 200, Json{{"deleted", 1}});
  server.script("DELETE /v1/maps/a/vertices", 200, Json{{"deleted", 5}});
  server.script("DELETE /v1/maps/a/vertices/3/image", 204, std::string());
  server.script("POST /v1/maps/a/vertices/3/restore", 200, Json{{"vertex", 3}, {"name", "x.jpg"}});
  const Ended deleted = ask("images delete a 3 --from 5 --to 9");
  EXPECT_EQ(deleted.code, 0) << deleted.err;
  EXPECT_EQ(deleted.out.rfind("6 images of a are deleted.", 0), 0u) << deleted.out;
  EXPECT_EQ(server.requests().back(), "DELETE /v1/maps/a/vertices?from=5&to=9");
  EXPECT_EQ(ask("images delete a --name 'y z.jpg'").code, 0);
  EXPECT_EQ(server.requests().back(), "DELETE /v1/maps/a/vertices?name=y%20z.jpg");
  EXPECT_EQ(ask("images delete a --pixels-only 3").out, "The pixels of 1 image of a are gone.\n");
  EXPECT_EQ(ask("images restore a 3").out, "Vertex 3 of a is back: x.jpg.\n");
  EXPECT_EQ(ask("images delete a").code, 2);
  EXPECT_EQ(ask("images delete a --from 3").code, 2);
}

TEST_F(Copies, AMapIsChanged) {
  server.script("PATCH /v1/maps/a", 200, Json{{"name", "b"}, {"kind", "map"}, {"labels", {{"floor", "2"}}}});
  const Ended changed = ask("map change a --name b --label floor=2");
  EXPECT_EQ(changed.code, 0) << changed.err;
  EXPECT_NE(changed.out.find("floor=2"), std::string::npos) << changed.out;
  EXPECT_EQ(Json::parse(server.bodies().back()), (Json{{"name", "b"}, {"labels", {{"floor", "2"}}}}));
  EXPECT_EQ(ask("map change a").code, 2);
}

TEST_F(Copies, AFileThatIsNotThereIsSaid) {
  EXPECT_EQ(ask("map import " + in_folder("none")).code, 2);
  server.script_problem("GET /v1/maps/lab-a/export", "no_such_map", "There is no map named \"lab-a\".");
  EXPECT_EQ(ask("map export lab-a " + in_folder("a.mapweld")).code, 1);
  EXPECT_FALSE(std::filesystem::exists(folder.path() / "a.mapweld"));
}

TEST_F(Copies, ABackupIsWaitedForFetchedAndTakenFromTheServer) {
  const Json running = {{"id", 7}, {"state", "running"}, {"progress", 0.5}, {"created_at", "2026-11-28T10:00:00Z"}};
  Json completed = running;
  completed["state"] = "completed";
  completed["bytes"] = 1'234'567;
  server.script("POST /v1/backups", 202, running);
  server.script_sequence("GET /v1/backups/7", {running, completed});
  server.script("GET /v1/backups/7/content", 200, std::string("all"));
  server.script("DELETE /v1/backups/7", 204, std::string());
  const Ended ended = ask("backup " + in_folder("all.db"));
  EXPECT_EQ(ended.code, 0) << ended.err;
  EXPECT_NE(ended.out.find("1.2 MB"), std::string::npos) << ended.out;
  EXPECT_EQ(client::read_file((folder.path() / "all.db").string()), "all");
  EXPECT_EQ(server.requests_of("DELETE /v1/backups/7"), 1u);
  EXPECT_EQ(ask("backup --keep " + in_folder("all.db")).code, 0);
  EXPECT_EQ(server.requests_of("DELETE /v1/backups/7"), 1u);

  Json failed = running;
  failed["state"] = "failed";
  failed["error"] = "The disk is full.";
  server.script("GET /v1/backups/7", 200, failed);
  const Ended refused = ask("backup " + in_folder("none.db"));
  EXPECT_EQ(refused.code, 1);
  EXPECT_FALSE(std::filesystem::exists(folder.path() / "none.db"));
}

}  // namespace
}  // namespace mapweld
