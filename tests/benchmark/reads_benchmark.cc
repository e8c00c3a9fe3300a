// What it costs to read a map: a vertex, a route, pages of vertices and edges (docs/storage.md, "Reading a map").
//
//   reads_benchmark [--vertices 20000,200000] [--folder DIR]
//
// A made-up map: each vertex has 7 edges of 60 inliers to the 20 before it, one in a hundred of them withheld. Beside
// it a merged map that shows the first thousand of its vertices. Processor time of a thread, medians; one line a
// figure.
#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>
#include <time.h>
#include <unistd.h>

#include "schema/merges/merge_store.h"
#include "server/api/replies.h"
#include "server/services/graph_export.h"
#include "server/services/map_service.h"
#include "server/services/route_service.h"
#include "tests/support/temp_store.h"

namespace mapweld {
namespace {

using test::Random;

constexpr std::uint32_t kWatermark = 1'000;
constexpr int kEdges = 7;
constexpr std::uint32_t kReach = 20;

double processor_ms() {
  timespec cpu{};
  ::clock_gettime(CLOCK_THREAD_CPUTIME_ID, &cpu);
  return static_cast<double>(cpu.tv_sec) * 1e3 + static_cast<double>(cpu.tv_nsec) / 1e6;
}

// The median of `repeats`, of which the first warms up.
void measure(const char* what, int repeats, const std::function<std::size_t()>& call) {
  std::vector<double> times_ms;
  std::size_t bytes = 0;
  for (int i = 0; i <= repeats; ++i) {
    const double begin_ms = processor_ms();
    bytes = call();
    if (i > 0 || repeats == 0) times_ms.push_back(processor_ms() - begin_ms);
  }
  std::ranges::sort(times_ms);
  std::printf("  %-52s %12.3f ms %12zu bytes\n", what, times_ms[times_ms.size() / 2], bytes);
  std::fflush(stdout);
}

void add_vertices(Store& store, MapId map, VocabularyId vocabulary, std::uint32_t first, std::uint32_t end) {
  constexpr std::uint32_t kAtOnce = 1'000;
  Random random(first + 1);
  const AppearanceVector image = test::random_appearances(random, 20, 50'000);
  const Verification verification = test::random_verification(random, 60, 300, 300);
  for (std::uint32_t begin = first; begin < end; begin += kAtOnce) {
    WriteTransaction db = store.write();
    const VerifierId verifier = test::test_verifier(db);
    for (std::uint32_t v = begin; v < std::min(end, begin + kAtOnce); ++v) {
      std::vector<NewEdge> edges;
      std::vector<std::uint32_t> ends;
      for (std::uint32_t back = 1; back <= std::min(v, kReach); ++back) ends.push_back(v - back);
      while (ends.size() > kEdges) ends.erase(ends.begin() + static_cast<std::ptrdiff_t>(random.below(ends.size())));
      for (const std::uint32_t u : ends) {
        NewEdge& edge = edges.emplace_back();
        edge.u = VertexId{u};
        edge.votes = 80;
        edge.verification = verification;
        edge.verification.inliers = 10 + static_cast<int>(random.below(90));
        if (random.chance(0.01)) edge.judgement = {0.25, Reason::kUnsupported, {}};
      }
      NewImage row = test::new_image(std::to_string(v) + ".jpg", image);
      row.provenance.sequence = "run-1";
      row.provenance.index = v;
      insert_vertex(db, map, vocabulary, row, image, edges, verifier);
    }
    db.commit();
  }
}

void run(const std::filesystem::path& folder, std::uint32_t vertices) {
  DataFolder data(folder);
  Store& store = data.store();
  const VocabularyId vocabulary = test::add_vocabulary(store, "words", 50'000);
  const MapId a = test::add_map(store, "a", vocabulary), b = test::add_map(store, "b", vocabulary);
  add_vertices(store, b, vocabulary, 0, 10);
  add_vertices(store, a, vocabulary, 0, kWatermark);
  {
    WriteTransaction db = store.write();
    const MapId merged = insert_merged_map(db, test::new_map("ab", vocabulary), std::vector{a, b});
    insert_merge(db, {merged, "quickconnect", 7, "{}", "{}", test::at(3)});
    db.commit();
  }
  add_vertices(store, a, vocabulary, kWatermark, vertices);
  std::printf("%u vertices, %llu edges\n", vertices, static_cast<unsigned long long>(find_map(store.read(), a)->edges));

  server::VocabularyService vocabularies(store);
  server::MapCache cache(store, std::size_t{1} << 30);
  server::MapOpener opener(store, cache);
  server::MapService maps(store, opener, vocabularies, [](std::int64_t) {});
  const auto size_of = [](const auto& document) { return server::json_reply(200, document).body.size(); };
  const auto edges_from = [&](const std::string& map, std::optional<bool> confirmed,
                              std::optional<std::string> cursor) {
    return maps.edges(map, {.confirmed = confirmed}, {1'000, std::move(cursor)});
  };
  const std::string last_vertex = std::to_string(vertices - 501), middle_vertex = std::to_string(vertices / 2);
  const std::string middle_edge = "0-" + std::to_string(std::uint64_t{vertices} * kEdges / 2);

  measure("a map", 5, [&] { return size_of(maps.get("a")); });
  measure("a merged map of an early state of it", 5, [&] { return size_of(maps.get("ab")); });
  measure("a vertex", 15, [&] { return size_of(maps.vertex("a", 5)); });
  measure("a vertex in the middle", 15, [&] { return size_of(maps.vertex("a", vertices / 2)); });
  measure("10 vertices", 15, [&] { return size_of(maps.vertices("a", {}, {10, middle_vertex})); });
  measure("1,000 vertices, as documents", 9, [&] {
    return maps.vertices("a", {}, {1'000, middle_vertex}).items.size();
  });
  measure("1,000 vertices, as JSON", 9, [&] { return size_of(maps.vertices("a", {}, {1'000, middle_vertex})); });
  measure("the last 500 vertices", 9, [&] { return size_of(maps.vertices("a", {}, {1'000, last_vertex})); });
  measure("the vertices of the merged map", 9, [&] { return size_of(maps.vertices("ab", {}, {1'000, {}})); });
  measure("1,000 edges", 9, [&] { return size_of(edges_from("a", {}, {})); });
  measure("1,000 edges from the middle", 9, [&] { return size_of(edges_from("a", {}, middle_edge)); });
  measure("1,000 withheld edges", 5, [&] { return size_of(edges_from("a", false, {})); });
  measure("all edges of the merged map", 3, [&] {
    std::size_t bytes = 0;
    contract::Page<contract::Edge> page;
    do {
      page = edges_from("ab", {}, page.next_cursor);
      bytes += size_of(page);
    } while (page.next_cursor);
    return bytes;
  });
  measure("all vertices, by the thousand", 1, [&] {
    std::size_t bytes = 0;
    contract::Page<contract::Vertex> page;
    do {
      page = maps.vertices("a", {}, {1'000, page.next_cursor});
      bytes += size_of(page);
    } while (page.next_cursor);
    return bytes;
  });
  measure("the graph, as JSON", 1, [&] {
    std::size_t bytes = 0;
    const auto next = server::export_graph(store, "a", server::GraphFormat::kJson);
    for (bool more = true; more;) {
      std::string piece;
      more = next(piece);
      bytes += piece.size();
    }
    return bytes;
  });
  std::size_t steps = 0;
  measure("a route from end to end", 1, [&] {
    const contract::Route route = server::find_route(store, "a", 0, vertices - 1);
    steps = route.edges.size();
    return size_of(route);
  });
  std::printf("  (of %zu edges)\n", steps);
}

}  // namespace
}  // namespace mapweld

int main(int argc, char** argv) {
  std::vector<std::uint32_t> vertices = {20'000, 200'000};
  std::filesystem::path folder = std::filesystem::temp_directory_path();
  CLI::App app("What it costs to read a map.");
  app.add_option("--vertices", vertices, "Sizes of the maps, more than 1,000")->delimiter(',');
  app.add_option("--folder", folder, "Where to make the databases");
  CLI11_PARSE(app, argc, argv);
  try {
    for (const std::uint32_t count : vertices) {
      const std::filesystem::path data = folder / ("mapweld-reads-benchmark-" + std::to_string(::getpid()));
      mapweld::run(data, count);
      std::filesystem::remove_all(data);
    }
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 1;
  }
  return 0;
}
