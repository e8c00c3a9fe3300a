// What the checksums of rows cost (docs/storage.md, "Checksums"): uploads and edges as the store takes them, with the
// triggers that keep checksums and without. (The INSERT of an edge reckons its checksum with or without: compare with a
// build of before.) Time of the processor; the files are where tests have theirs.
#include <benchmark/benchmark.h>

#include "tests/support/temp_store.h"

namespace mapweld {
namespace {

using test::Random;

void take_triggers_away(WriteTransaction& db) {
  std::vector<std::string> names;
  {
    sqlite::Statement trigger = db.prepare("SELECT name FROM sqlite_temp_schema WHERE type = 'trigger'");
    while (trigger.step()) names.emplace_back(trigger.text(0));
  }
  for (const std::string& name : names) db.connection().execute("DROP TRIGGER temp." + name);
}

class World {
 public:
  explicit World(const benchmark::State& state) {
    if (state.range(0) == 0) {
      WriteTransaction db = store_.write();
      take_triggers_away(db);
      db.commit();
    }
  }

  // A vertex with so many edges of 60 inliers to those before it; one transaction.
  void upload(std::size_t edges) {
    std::vector<NewEdge> own;
    for (std::size_t e = 1; e <= std::min<std::size_t>(count_, edges); ++e) {
      own.push_back({VertexId{count_ - static_cast<std::uint32_t>(e)}, {}, 80, verdict_});
    }
    NewImage row = test::new_image(std::to_string(count_++), image_);
    row.bytes = bytes_;
    WriteTransaction db = store_.write();
    insert_vertex(db, map_, vocabulary_, row, image_, own, test::test_verifier(db));
    db.commit();
  }

  // `edges` edges of one map, no two alike; one transaction.
  void connect(std::uint32_t edges) {
    WriteTransaction db = store_.write();
    std::vector<NewEdge> own;
    for (std::uint32_t e = 0; e < edges; ++e) {
      if (++v_ == count_) v_ = ++u_ + 1;
      own.push_back({VertexId{u_}, VertexId{v_}, 80, verdict_});
    }
    insert_edges(db, map_, own, test::test_verifier(db), std::nullopt);
    db.commit();
  }

  void judge(std::uint32_t edges) {
    WriteTransaction db = store_.write();
    sqlite::Statement judged = db.prepare("UPDATE edges SET confidence = ?2 WHERE id = ?1");
    for (std::uint32_t e = 1; e <= edges; ++e) judged.bind_all(e, confidence_ += 1e-9).run();
    db.commit();
  }

 private:
  Random random_{7};
  test::TempStore store_;
  VocabularyId vocabulary_ = test::add_vocabulary(store_);
  MapId map_ = test::add_map(store_, "a", vocabulary_);
  const AppearanceVector image_ = test::random_appearances(random_, 400, 1'000, true);
  const std::vector<std::uint8_t> bytes_ = test::random_bytes(random_, 15'000);
  const Verification verdict_ = test::random_verification(random_, 60, 300, 300);
  std::uint32_t count_ = 0;
  std::uint32_t u_ = 0;
  std::uint32_t v_ = 0;
  double confidence_ = 0.5;
};

constexpr std::uint32_t kEdges = 100;

// An image of 15 kB with 400 appearances and 7 edges, committed.
void upload(benchmark::State& state) {
  World world(state);
  for ([[maybe_unused]] const auto _ : state) world.upload(7);
}
BENCHMARK(upload)->ArgName("checksums")->Arg(0)->Arg(1)->Iterations(3'000);

void insert_edges(benchmark::State& state) {
  World world(state);
  for (int i = 0; i < 1'000; ++i) world.upload(0);
  for ([[maybe_unused]] const auto _ : state) world.connect(kEdges);
}
BENCHMARK(insert_edges)->ArgName("checksums")->Arg(0)->Arg(1)->Iterations(300);

// Their confidence changes.
void judge_edges(benchmark::State& state) {
  World world(state);
  for (int i = 0; i < 1'000; ++i) world.upload(0);
  world.connect(kEdges);
  for ([[maybe_unused]] const auto _ : state) world.judge(kEdges);
}
BENCHMARK(judge_edges)->ArgName("checksums")->Arg(0)->Arg(1)->Iterations(1'000);

}  // namespace
}  // namespace mapweld
