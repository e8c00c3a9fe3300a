// One merge in memory from beginning to end, written down edge by edge so that everything else can be computed
// afterwards: measuring does not disturb what is measured.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <unordered_map>
#include <vector>

#include "core/merge/make_merger.h"
#include "core/merge/merge_input.h"
#include "core/merge/merge_state.h"
#include "core/types.h"

namespace mapweld::server::evaluation {

// What a run had spent at one moment.
struct Cost {
  std::uint64_t verifications = 0;
  double elapsed_s = 0;   // processor time of the thread that merges
  double verifier_s = 0;  // of it, inside the verifier
};

// The axes along which methods are compared.
enum class CostAxis : std::uint8_t {
  kVerifications,
  kTime,          // elapsed_s
  kModelledTime,  // elapsed_s - verifier_s + verifications * the seconds that a modelled verifier takes
};
double on_axis(const Cost& cost, CostAxis axis, double modelled_verifier_s);

struct RecordedEdge {
  VertexId u{};  // u < v, merged numbers
  VertexId v{};
  std::uint32_t inliers = 0;  // its weight
  std::uint32_t votes = 0;
  Cost cost;  // when it was inserted, its own verification included
  // Of the finished merge, where its edges are judged.
  std::optional<double> confidence = {};
  bool confirmed = true;
};

struct RecordedRun {
  std::string method;
  std::uint64_t seed = 0;
  std::vector<RecordedEdge> edges;  // in order of insertion
  Cost cost;                        // of the whole merge
  // QuickConnect: when exploration ended. None for a method without that phase.
  std::optional<Cost> exploration_end;
};

// Told now and then how many verifications have been made.
using RunProgress = std::function<void(std::uint64_t verifications)>;

// Merges until done on the calling thread. The clock begins before the merger is made; the word index is not charged
// when `input.votes` is set. Throws std::invalid_argument as make_merger does.
// `last`, when it is given, becomes the merge's last state.
RecordedRun record_run(MergeInput input, const RunProgress& progress = {}, MergeState* last = nullptr);

// A verifier that looks a verdict up which it has given before. Pairs are known by the addresses of their appearance
// vectors, which must stay where they are as long as this lives. Thread-safe.
class MemoVerifier final : public PairVerifier {
 public:
  explicit MemoVerifier(std::shared_ptr<const PairVerifier> verifier) : verifier_(std::move(verifier)) {}
  Verification verify(const AppearanceVector& a, const AppearanceVector& b) const override;
  std::string version() const override { return verifier_->version(); }
  const VerifierOptions& options() const override { return verifier_->options(); }

 private:
  using Key = std::pair<const AppearanceVector*, const AppearanceVector*>;
  struct KeyHash {
    std::size_t operator()(const Key& key) const {
      const std::hash<const AppearanceVector*> hash;
      return hash(key.first) * 0x9E3779B97F4A7C15u ^ hash(key.second);
    }
  };
  std::shared_ptr<const PairVerifier> verifier_;
  mutable std::mutex mutex_;
  mutable std::unordered_map<Key, Verification, KeyHash> known_;
};

}  // namespace mapweld::server::evaluation
