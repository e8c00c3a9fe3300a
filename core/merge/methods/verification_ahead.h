// Verdicts reached before their turn: while one thread drives the merge, the others verify what it is expected to ask
// for.
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <unordered_map>
#include <vector>

#include "core/merge/executor.h"
#include "core/merge/merge_input.h"
#include "core/types.h"

namespace mapweld {

// A verdict is a pure function of its pair. So this is a cache and no part of a merge's state: a wrong guess at what
// comes next costs time and changes nothing. So is what the verifier has prepared of the images that it was asked
// about. Used by one thread; the executor's others work for it from one call to the next, also while the caller does
// something else.
class VerificationAhead {
 public:
  // Pairs that are looked ahead: twice as many each time while guesses are right, up to what others can verify while
  // the caller is busy for a tenth of a second; half as many after a wrong one.
  static constexpr std::size_t kLeastAhead = 64, kMostAhead = 2048;
  // Pairs of one task: who waits for the others' threads waits for no longer.
  static constexpr std::size_t kTask = 32;
  // Verdicts that are kept for a turn that has not come; past that, all are forgotten.
  static constexpr std::size_t kMostKept = std::size_t{1} << 16;
  // Images that are kept prepared; past that, all are forgotten.
  static constexpr std::size_t kMostPrepared = 4096;

  // `input` must outlive this.
  explicit VerificationAhead(const MergeInput& input) : input_(input) {}
  ~VerificationAhead();
  VerificationAhead(const VerificationAhead&) = delete;
  VerificationAhead& operator=(const VerificationAhead&) = delete;

  // Appends to its argument up to so many candidates, in the order in which they are expected to be asked for.
  using Upcoming = std::function<void(std::size_t most, std::vector<Candidate>& candidates)>;

  // The verdict on (u, v), u < v. Where there is an executor of two threads or more, the `upcoming` pairs are verified
  // beside. What cannot be read for those is left for their own turn; what cannot be read for (u, v) throws.
  Verification take(VertexId u, VertexId v, const Upcoming& upcoming);

 private:
  // An image, prepared by whoever needs it first.
  struct Image {
    std::mutex mutex;
    std::shared_ptr<const PreparedImage> prepared;
  };
  struct Pair {
    enum State : std::uint8_t { kOpen, kTaken, kDone };
    std::shared_ptr<Image> of_u, of_v;
    VertexId u{}, v{};
    std::atomic<std::uint8_t> state = kOpen;
    std::optional<Verification> verdict;  // kDone: none when something could not be read
  };
  // What was expected at one time. Each pair is taken by whoever comes to it first.
  struct Plan {
    std::vector<std::shared_ptr<Pair>> pairs;
    std::atomic<std::size_t> next = 0;
  };

  static Verification verify(const MergeInput& input, Pair& pair);
  static bool work_on(const MergeInput& input, Plan& plan);
  static bool work_on(const MergeInput& input, Pair& pair);
  std::shared_ptr<Image> image(VertexId vertex);
  std::shared_ptr<Pair> pair_of(VertexId u, VertexId v);
  void look_ahead(VertexId u, VertexId v, const Upcoming& upcoming);
  void make_plan(VertexId u, VertexId v, const Upcoming& upcoming);

  const MergeInput& input_;
  std::unordered_map<std::uint64_t, std::shared_ptr<Pair>> pairs_;  // expected and not asked for yet, by both ends
  std::unordered_map<VertexId, std::shared_ptr<Image>> images_;
  std::shared_ptr<Plan> plan_ = std::make_shared<Plan>();
  std::size_t taken_of_plan_ = 0;  // asked for since it was made
  std::size_t ahead_ = kLeastAhead;
  std::vector<Candidate> candidates_;  // scratch
  std::unique_ptr<TaskLine> line_;     // the last member: its tasks use the others
};

// Both ends of a pair as one number; the same for (u, v) and (v, u).
constexpr std::uint64_t pair_key(VertexId u, VertexId v) {
  const std::uint64_t a = to_index(u), b = to_index(v);
  return a < b ? a << 32 | b : b << 32 | a;
}

}  // namespace mapweld
