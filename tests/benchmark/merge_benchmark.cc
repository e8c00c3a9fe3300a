// What merging costs apart from the verifier: votes, steps, checkpoints. docs/merging.md holds the figures.
#include <algorithm>
#include <ctime>
#include <fstream>
#include <map>
#include <utility>

#include <benchmark/benchmark.h>
#include <unistd.h>

#include "core/merge/make_merger.h"
#include "core/merge/merge_metrics.h"
#include "core/merge/methods/quick_connect.h"
#include "core/merge/run.h"
#include "core/merge/vote_source.h"
#include "core/retrieval/word_voter.h"
#include "schema/blobs/merge_state_blob.h"
#include "tests/benchmark/simulated_maps.h"

namespace mapweld {
namespace {

const MergeInput& maps_of(const benchmark::State& state) {
  static std::map<std::pair<std::int64_t, std::int64_t>, MergeInput> known;
  const auto key = std::pair(state.range(0), state.range(1));
  auto found = known.find(key);
  if (found == known.end()) {
    MergeInput input =
        test::simulated_maps(static_cast<std::uint32_t>(key.first), static_cast<std::uint32_t>(key.second));
    input.votes = std::make_shared<WordVotes>(*input.appearances, input.members[0], input.members[1]);
    found = known.emplace(key, std::move(input)).first;
  }
  return found->second;
}

void Index(benchmark::State& state) {
  const MergeInput& input = maps_of(state);
  for (auto _ : state) WordVotes(*input.appearances, input.members[0], input.members[1]);
}

// All of S, word by word, as QuickConnect fills it.
void SimilarityByWords(benchmark::State& state, VoteRule rule, std::uint32_t min_votes) {
  const MergeInput& input = maps_of(state);
  std::size_t candidates = 0;
  for (auto _ : state) {
    SimilarityMatrix matrix = SimilarityMatrix::dense(input.votes->rows(), input.votes->columns());
    std::vector<SimilarityMatrix::Cell> reached;
    std::vector<VotedVertex> given;
    WordVoter voter(rule);
    for (std::uint32_t w = 0; w < input.votes->words().size(); ++w) {
      const PostingSpan rows = input.votes->row_postings(w);
      for (std::size_t from = 0, to = 0; from < rows.size(); from = to) {
        to = end_of_vertex(rows.vertices, from);
        given.clear();
        voter.vote(rows.signatures.subspan(from, to - from), input.votes->column_postings(w),
                   [&given](VertexId column, std::uint32_t votes) {
                     given.push_back({column, votes});
                   });
        matrix.add(to_index(rows.vertices[from]), given, min_votes, reached);
      }
    }
    candidates = reached.size();
  }
  state.counters["candidates"] = static_cast<double>(candidates);
}

void SimilarityByRows(benchmark::State& state, VoteRule rule, std::uint32_t min_votes) {
  const MergeInput& input = maps_of(state);
  std::uint64_t candidates = 0;
  for (auto _ : state) candidates = count_candidates(*input.votes, rule, min_votes);
  state.counters["candidates"] = static_cast<double>(candidates);
}

// The whole merge with a verifier that takes no time.
void Steps(benchmark::State& state, const char* method) {
  MergeInput input = maps_of(state);
  input.options.method = method;
  std::uint64_t steps = 0, verifications = 0;
  for (auto _ : state) {
    const auto merger = make_merger(input);
    run(*merger, {});
    steps = merger->state().step;
    verifications = merger->state().verifications;
  }
  state.counters["steps"] = static_cast<double>(steps);
  state.counters["verifications"] = static_cast<double>(verifications);
}
void QuickConnectSteps(benchmark::State& state) { Steps(state, "quickconnect"); }
void BruteForceSteps(benchmark::State& state) { Steps(state, "brute-force"); }
void AlignmentSteps(benchmark::State& state) { Steps(state, "alignment"); }

double resident_mb() {
  std::ifstream statm("/proc/self/statm");
  double pages = 0;
  statm >> pages >> pages;
  return pages * static_cast<double>(sysconf(_SC_PAGESIZE)) / 1e6;
}

// Everything that `spectral` does before it verifies: S by rows. Its longest step, in processor time; what the process
// grows by; and the checkpoint of all of it, which is the dearest that there is.
void SpectralVoting(benchmark::State& state) {
  MergeInput input = maps_of(state);
  input.options.method = "spectral";
  double longest_s = 0, grown_mb = 0, checkpoint_s = 0, checkpoint_mb = 0;
  std::uint64_t candidates = 0;
  for (auto _ : state) {
    const double before_mb = resident_mb();
    const auto merger = make_merger(input);
    longest_s = 0;
    while (merger->state().phase == MergePhase::kVoting) {
      const std::clock_t start = std::clock();
      merger->step();
      longest_s = std::max(longest_s, static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC);
    }
    candidates = merger->state().candidates_known;
    grown_mb = resident_mb() - before_mb;
    state.PauseTiming();
    const std::clock_t start = std::clock();
    checkpoint_mb = 0;
    for (const auto& part : blobs::encode_merge_state(merger->state(), std::nullopt)) {
      checkpoint_mb += static_cast<double>(part.bytes.size()) / 1e6;
    }
    checkpoint_s = static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC;
    state.ResumeTiming();
  }
  state.counters["longest_step_ms"] = longest_s * 1e3;
  state.counters["candidates"] = static_cast<double>(candidates);
  state.counters["grown_mb"] = grown_mb;
  state.counters["checkpoint_ms"] = checkpoint_s * 1e3;
  state.counters["checkpoint_mb"] = checkpoint_mb;
}

// Everything that `alignment` does before it verifies: S, and the alignments; and its longest step, in processor time.
void AlignmentVoting(benchmark::State& state) {
  MergeInput input = maps_of(state);
  input.options.method = "alignment";
  double longest_s = 0;
  std::uint64_t cells = 0, candidates = 0, transitions = 0;
  for (auto _ : state) {
    const auto merger = make_merger(input);
    longest_s = 0;
    while (merger->state().phase == MergePhase::kVoting) {
      const std::clock_t start = std::clock();
      merger->step();
      const double step_s = static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC;
      longest_s = std::max(longest_s, step_s);
    }
    cells = merger->state().search.similarity.kept_columns().size();
    transitions = merger->state().search.word_next_row;
    candidates = merger->state().candidates_known;
  }
  state.counters["longest_step_ms"] = longest_s * 1e3;
  state.counters["cells"] = static_cast<double>(cells);
  state.counters["alignment_steps"] = static_cast<double>(transitions);
  state.counters["candidates"] = static_cast<double>(candidates);
}

std::unique_ptr<Merger> half_explored(const MergeInput& input) {
  auto merger = make_merger(input);
  run(*merger, stop_when_merger(
                   [](const Merger& m) {
                     return m.state().search.words_processed * 2 >= m.words_total() &&
                            m.state().phase != MergePhase::kVoting;
                   },
                   StopReason::kPaused));
  return merger;
}

// Encoding a checkpoint in the middle of exploration, when S is written, ...
void CheckpointInExploration(benchmark::State& state) {
  const auto merger = half_explored(maps_of(state));
  std::size_t bytes = 0;
  for (auto _ : state) {
    bytes = 0;
    for (const auto& part : blobs::encode_merge_state(merger->state(), std::nullopt)) bytes += part.bytes.size();
  }
  state.counters["bytes"] = static_cast<double>(bytes);
}

// ... in refinement, when it is not, ...
void CheckpointInRefinement(benchmark::State& state) {
  const auto merger = make_merger(maps_of(state));
  run(*merger, {});
  const blobs::MergeStateMark mark{.phase = MergePhase::kRefinement, .rejected = merger->state().rejected.size() - 100};
  std::size_t bytes = 0;
  for (auto _ : state) {
    bytes = 0;
    for (const auto& part : blobs::encode_merge_state(merger->state(), mark)) bytes += part.bytes.size();
  }
  state.counters["bytes"] = static_cast<double>(bytes);
}

// ... and going on from it.
void Resume(benchmark::State& state) {
  const MergeInput& input = maps_of(state);
  const auto merger = half_explored(input);
  const auto parts = blobs::encode_merge_state(merger->state(), std::nullopt);
  for (auto _ : state) make_merger(input, blobs::decode_merge_state(parts, merger->state().edges));
}

void Metrics(benchmark::State& state) {
  const auto merger = make_merger(maps_of(state));
  run(*merger, {});
  MergeMetrics metrics;
  for (auto _ : state) metrics = merge_metrics(merger->graph(), merger->input().members, merger->state().edges);
  state.counters["lambda2"] = metrics.largest_algebraic_connectivity;
  state.counters["edges"] = static_cast<double>(merger->state().edges.size());
}

void sizes(benchmark::internal::Benchmark* benchmark) {
  benchmark->Args({1356, 610})->Args({3000, 2000})->Args({6000, 6000})->Unit(benchmark::kMillisecond);
}
BENCHMARK(Index)->Apply(sizes);
BENCHMARK_CAPTURE(SimilarityByWords, min, VoteRule::kMin, 12)->Apply(sizes);
BENCHMARK_CAPTURE(SimilarityByWords, signatures, VoteRule::kSignatures, 3)->Apply(sizes);
BENCHMARK_CAPTURE(SimilarityByRows, min, VoteRule::kMin, 12)->Apply(sizes);
BENCHMARK_CAPTURE(SimilarityByRows, signatures, VoteRule::kSignatures, 3)->Apply(sizes);
BENCHMARK(QuickConnectSteps)->Apply(sizes);
BENCHMARK(BruteForceSteps)->Apply(sizes);
BENCHMARK(AlignmentSteps)->Apply(sizes);
BENCHMARK(SpectralVoting)->Apply(sizes)->Args({20000, 20000});
BENCHMARK(AlignmentVoting)->Apply(sizes)->Args({20000, 20000});
BENCHMARK(CheckpointInExploration)->Apply(sizes);
BENCHMARK(CheckpointInRefinement)->Apply(sizes);
BENCHMARK(Resume)->Apply(sizes);
BENCHMARK(Metrics)->Apply(sizes);

}  // namespace
}  // namespace mapweld
