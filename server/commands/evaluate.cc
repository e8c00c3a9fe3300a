#include "server/commands/evaluate.h"

#include <algorithm>
#include <array>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <memory>
#include <optional>
#include <sstream>
#include <stdexcept>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include <CLI/CLI.hpp>

#include "core/geometry/epipolar_verifier.h"
#include "schema/engine/data_folder.h"
#include "schema/maps/map_layout.h"
#include "schema/maps/vertex_store.h"
#include "server/commands/progress_bar.h"
#include "server/evaluation/candidate_verdicts.h"
#include "server/evaluation/contact_sheet.h"
#include "server/evaluation/evaluation.h"
#include "server/evaluation/figures.h"
#include "server/evaluation/report.h"
#include "server/evaluation/truth.h"
#include "server/evaluation/truth_metrics.h"
#include "server/jobs/merge_input_loader.h"

namespace mapweld::server {
namespace {

namespace fs = std::filesystem;
using namespace evaluation;  // NOLINT(google-build-using-namespace)

constexpr int kFailed = 1;
constexpr std::size_t kPairsOnSheet = 12;

struct EvaluateArguments {
  fs::path data;
  std::vector<std::string> maps;
  fs::path out;
  fs::path truth;
  TruthOptions truth_options;
  EvaluationOptions evaluation;
  double verifier_ms = 20;
  MergeOptions merge;
  VerifierOptions verifier;
  std::string votes{to_string(MergeOptions{}.votes)};
  std::uint32_t min_votes = 0;  // 0: the rule's
  std::size_t max_sheet_pairs = 48;
  std::size_t sample_edges = 0;
};

std::string read_text(const fs::path& path) {
  std::ifstream in(path, std::ios::binary);
  std::ostringstream text;
  text << in.rdbuf();
  if (!in) throw std::runtime_error("cannot read " + path.string());
  return text.str();
}

void write_file(const fs::path& path, const void* bytes, std::size_t size) {
  std::ofstream out(path, std::ios::binary);
  out.write(static_cast<const char*>(bytes), static_cast<std::streamsize>(size));
  out.close();
  if (!out) throw std::runtime_error("cannot write " + path.string());
}

NamedMap named_map(const Reader& db, const MapRow& map) {
  constexpr std::size_t kPage = 1000;
  const MapLayout layout = load_layout(db, map.id);
  NamedMap named{map.name, std::vector<std::string>(layout.vertices())};
  std::optional<VertexId> after;
  while (true) {
    const std::vector<VertexRow> rows = list_vertices(db, layout, kPage, after);
    if (rows.empty()) return named;
    for (const VertexRow& row : rows) named.images.at(to_index(row.vertex)) = row.image.name;
    after = rows.back().vertex;
  }
}

std::vector<std::uint8_t> image_bytes(const Reader& db, const MapRow& map, std::uint32_t vertex) {
  const LeafVertex leaf = load_layout(db, map.id).leaf(VertexId{vertex});
  const std::optional<ImageRow> image = find_vertex(db, leaf.map, leaf.vertex);
  if (!image) return {};
  return load_image_bytes(db, image->id).value_or(std::vector<std::uint8_t>{});
}

// Writes NAME-1.png, NAME-2.png, ... of these edges, and which they are as NAME.csv.
void write_sheets(const Reader& db, const LoadedMaps& loaded, const std::array<NamedMap, 2>& named,
                  const std::vector<RecordedEdge>& edges, const fs::path& out, const std::string& name) {
  std::string csv = "sheet,a,b,inliers,votes\n";
  for (std::size_t from = 0; from < edges.size(); from += kPairsOnSheet) {
    const std::string number = std::to_string(from / kPairsOnSheet + 1);
    std::vector<SheetPair> pairs;
    for (std::size_t i = from; i < std::min(edges.size(), from + kPairsOnSheet); ++i) {
      const MapPair pair = pair_of(edges[i], static_cast<std::uint32_t>(named[0].images.size()));
      const std::string &a = named[0].images[pair.a], &b = named[1].images[pair.b];
      pairs.push_back({image_bytes(db, loaded.maps[0], pair.a), image_bytes(db, loaded.maps[1], pair.b),
                       std::to_string(i + 1) + ": " + a + " - " + b + ", " + std::to_string(edges[i].inliers) +
                           " inliers, " + std::to_string(edges[i].votes) + " votes"});
      csv += number + "," + a + "," + b + "," + std::to_string(edges[i].inliers) + "," +
             std::to_string(edges[i].votes) + "\n";
    }
    const std::vector<std::uint8_t> png = contact_sheet(pairs);
    write_file(out / (name + "-" + number + ".png"), png.data(), png.size());
  }
  write_file(out / (name + ".csv"), csv.data(), csv.size());
}

// The wrong edges, those not even listed first, then by weight; at most `limit`.
std::vector<RecordedEdge> worst_edges(const Evaluation& evaluation, const Truth& truth, std::size_t limit) {
  std::vector<RecordedEdge> wrong;
  const std::uint32_t first = evaluation.member_vertices.front();
  for (const RecordedEdge& edge : evaluation.all_edges) {
    const MapPair pair = pair_of(edge, first);
    if (!truth.is_right(pair.a, pair.b)) wrong.push_back(edge);
  }
  std::ranges::stable_sort(wrong, [&](const RecordedEdge& x, const RecordedEdge& y) {
    const MapPair p = pair_of(x, first), q = pair_of(y, first);
    const bool listed_x = truth.is_listed(p.a, p.b), listed_y = truth.is_listed(q.a, q.b);
    return listed_x != listed_y ? listed_y : x.inliers > y.inliers;
  });
  if (wrong.size() > limit) wrong.resize(limit);
  return wrong;
}

// `count` of all edges, evenly spaced in their order by ends.
std::vector<RecordedEdge> sampled_edges(const std::vector<RecordedEdge>& edges, std::size_t count) {
  std::vector<RecordedEdge> sample;
  count = std::min(count, edges.size());
  for (std::size_t i = 0; i < count; ++i) sample.push_back(edges[(2 * i + 1) * edges.size() / (2 * count)]);
  return sample;
}

// Every edge of the finished merge by the names of its images; `right` is empty without a truth.
std::string edges_csv(const Evaluation& evaluation, const std::array<NamedMap, 2>& named, const Truth* truth) {
  std::string csv = "a,b,inliers,votes,right,confidence,confirmed\n";
  for (const RecordedEdge& edge : evaluation.all_edges) {
    const MapPair pair = pair_of(edge, evaluation.member_vertices.front());
    csv += named[0].images[pair.a] + "," + named[1].images[pair.b] + "," + std::to_string(edge.inliers) + "," +
           std::to_string(edge.votes) + ",";
    if (truth != nullptr) csv += truth->is_right(pair.a, pair.b) ? "1" : "0";
    csv += "," + (edge.confidence ? std::to_string(*edge.confidence) : "") + (edge.confirmed ? ",1\n" : ",0\n");
  }
  return csv;
}

std::string command_of(const EvaluateArguments& arguments) {
  std::string command = "mapweld-server evaluate --data DIR --maps " + arguments.maps[0] + " " + arguments.maps[1];
  if (!arguments.evaluation.methods.empty()) {
    command += " --methods ";
    for (std::size_t i = 0; i < arguments.evaluation.methods.size(); ++i) {
      command += (i > 0 ? "," : "") + arguments.evaluation.methods[i];
    }
  }
  command +=
      " --runs " + std::to_string(arguments.evaluation.runs) + " --seed " + std::to_string(arguments.evaluation.seed);
  if (arguments.evaluation.memo) command += " --memo";
  if (arguments.evaluation.confirmed) command += " --confirmed";
  if (!arguments.truth.empty()) command += " --truth " + arguments.truth.filename().string();
  return command + " --out DIR";
}

void run_evaluate(EvaluateArguments arguments) {
  arguments.evaluation.modelled_verifier_s = arguments.verifier_ms / 1000;
  arguments.merge.votes = parse_vote_rule(arguments.votes).value_or(arguments.merge.votes);
  arguments.merge.min_votes = arguments.min_votes > 0 ? arguments.min_votes : default_min_votes(arguments.merge.votes);
  fs::create_directories(arguments.out);

  DataFolderOptions inspect;
  inspect.access = DataFolderOptions::Access::kInspect;
  DataFolder folder(arguments.data, inspect);
  std::optional<LoadedMaps> loaded;
  std::array<NamedMap, 2> named;
  {
    const ReadTransaction db = folder.store().read();
    loaded = load_maps(db, arguments.maps);
    arguments.evaluation.inner_edges = std::move(loaded->verified_inner_edges);
    named = {named_map(db, loaded->maps[0]), named_map(db, loaded->maps[1])};
  }
  std::optional<Truth> truth;
  if (!arguments.truth.empty()) truth = Truth::parse(read_text(arguments.truth), named, arguments.truth_options);

  MergeInput& input = loaded->input;
  input.options = arguments.merge;
  if (arguments.evaluation.confirmed) {
    input.inner_edges =
        confirmed_inner_edges(input, arguments.evaluation.inner_edges, arguments.evaluation.min_confidence);
  }
  input.verifier = make_verifier(arguments.verifier);
  const std::string version = input.verifier->version();
  if (arguments.evaluation.memo) input.verifier = std::make_shared<MemoVerifier>(input.verifier);

  ProgressBar progress;
  std::ranges::sort(arguments.evaluation.levels);
  arguments.evaluation.guard = true;
  const Evaluation evaluation = evaluate(input, arguments.evaluation,
                                         [&](const EvaluationProgress& p) { progress.show(p.stage, p.done, p.total); });
  std::optional<TruthResult> judged;
  if (truth) {
    VerifierOptions lenient = kLenient;
    lenient.signatures = arguments.verifier.signatures;
    input.verifier = make_verifier(lenient);
    std::vector<CandidateVerdict> verdicts =
        verify_candidates(input, arguments.evaluation.threads,
                          [&](std::uint64_t done) { progress.show("verdicts", done, evaluation.candidates); });
    judged = judge(std::move(verdicts), std::move(*truth), input, evaluation, arguments.verifier);
  }
  progress.end();

  const std::string pair = arguments.maps[0] + " + " + arguments.maps[1];
  std::vector<OutputFile> files = figures(evaluation, pair);
  if (judged) std::ranges::move(truth_figures(evaluation, *judged, pair), std::back_inserter(files));
  const ReportHead head{arguments.maps[0], arguments.maps[1],  command_of(arguments),
                        arguments.merge,   arguments.verifier, version};
  files.push_back({"edges.csv", edges_csv(evaluation, named, judged ? &judged->truth : nullptr)});
  files.push_back({"report.md", markdown_report(head, evaluation, judged ? &*judged : nullptr)});
  for (const OutputFile& file : files) write_file(arguments.out / file.name, file.content.data(), file.content.size());

  const ReadTransaction db = folder.store().read();
  if (judged) {
    write_sheets(db, *loaded, named, worst_edges(evaluation, judged->truth, arguments.max_sheet_pairs), arguments.out,
                 "wrong-edges-sheet");
  }
  if (arguments.sample_edges > 0) {
    write_sheets(db, *loaded, named, sampled_edges(evaluation.all_edges, arguments.sample_edges), arguments.out,
                 "edges-sheet");
  }
  std::cout << (arguments.out / "report.md").string() << std::endl;
}

}  // namespace

void add_evaluate_command(CLI::App& app) {
  const auto arguments = std::make_shared<EvaluateArguments>();
  arguments->evaluation.threads = static_cast<int>(std::max(1u, std::thread::hardware_concurrency()));
  CLI::App* command = app.add_subcommand(
      "evaluate", "Merges two stored maps by every method, in memory, and compares them; also beside a running server");
  command->add_option("--data", arguments->data, "Data folder")->envname("MAPWELD_DATA")->required();
  command->add_option("--maps", arguments->maps, "The two maps")->required()->expected(2);
  command->add_option("--out", arguments->out, "Folder for report.md and the figures; made if missing")->required();
  command->add_option("--methods", arguments->evaluation.methods, "Methods, separated by commas; default: all")
      ->delimiter(',');
  command->add_option("--runs", arguments->evaluation.runs, "Runs of each method that draws at random")
      ->check(CLI::Range(1u, 10000u))
      ->capture_default_str();
  command->add_option("--levels", arguments->evaluation.levels, "Shares of the final value whose cost is told")
      ->delimiter(',')
      ->check(CLI::Range(0.0, 1.0))
      ->capture_default_str();
  command->add_option("--seed", arguments->evaluation.seed, "Seed of the first run; the others follow")
      ->capture_default_str();
  command->add_flag("--memo", arguments->evaluation.memo,
                    "Verify each pair once for all methods; costs are then counted in verifications only");
  command->add_flag("--confirmed", arguments->evaluation.confirmed,
                    "Count only the edges that the alias guard confirms in the end, as a guarded merge does");
  command->add_option("--min-confidence", arguments->evaluation.min_confidence, "Confidence of a confirmed edge")
      ->check(CLI::Range(0.0, 1.0))
      ->capture_default_str();
  command->add_option("--verifier-ms", arguments->verifier_ms, "Also the time with a verifier that takes so long")
      ->check(CLI::NonNegativeNumber)
      ->capture_default_str();
  command->add_option("--threads", arguments->evaluation.threads, "For eigenvalues; merges are timed on one")
      ->check(CLI::Range(1, 1024))
      ->capture_default_str();
  command->add_option("--votes", arguments->votes, "What votes: equal words, or those whose signatures agree")
      ->check(CLI::IsMember({"min", "product", "signatures"}))
      ->capture_default_str();
  command
      ->add_option("--min-votes", arguments->min_votes,
                   "Votes that make a pair a candidate (default: 3 by signatures, 10 by words)")
      ->check(CLI::Range(1u, 65535u));
  command->add_option("--min-inliers", arguments->verifier.min_inliers, "Inliers that make a candidate an edge")
      ->check(CLI::Range(4, 65535))
      ->capture_default_str();
  command->add_flag_function(
      "--words-only", [arguments](std::int64_t) { arguments->verifier.signatures = false; },
      "Verify by words alone, as the paper does; best with --max-false-alarms 1e-6");
  command->add_option("--max-false-alarms", arguments->verifier.max_false_alarms, "Its significance")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  command
      ->add_option("--truth", arguments->truth, "CSV of the pairs that show one place, or of the poses of all images")
      ->check(CLI::ExistingFile);
  command
      ->add_option("--truth-min-shared", arguments->truth_options.min_shared,
                   "Pairs with a column `shared`: right from this share on")
      ->capture_default_str();
  command
      ->add_option("--truth-max-distance-m", arguments->truth_options.max_distance_m, "Poses: right up to so far apart")
      ->capture_default_str();
  command->add_option("--truth-max-turn-deg", arguments->truth_options.max_turn_deg, "Poses: and turned so far")
      ->capture_default_str();
  command->add_option("--max-sheet-pairs", arguments->max_sheet_pairs, "Wrong edges on contact sheets, at most")
      ->capture_default_str();
  command
      ->add_option("--sample-edges", arguments->sample_edges,
                   "Contact sheets of so many edges, evenly spaced, for judging by eye")
      ->capture_default_str();
  command->callback([arguments] {
    try {
      run_evaluate(*arguments);
    } catch (const std::exception& error) {
      std::cerr << "mapweld-server: " << error.what() << std::endl;
      throw CLI::RuntimeError(kFailed);
    }
  });
}

}  // namespace mapweld::server
