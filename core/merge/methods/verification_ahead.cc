#include "core/merge/methods/verification_ahead.h"

#include <algorithm>
#include <exception>
#include <utility>

namespace mapweld {

VerificationAhead::~VerificationAhead() { plan_->next = plan_->pairs.size(); }

Verification VerificationAhead::take(VertexId u, VertexId v, const Upcoming& upcoming) {
  const bool has_others = input_.executor && input_.executor->concurrency() > 1;
  if (has_others) look_ahead(u, v, upcoming);
  const std::shared_ptr<Pair> pair = pair_of(u, v);
  if (has_others) {
    ++taken_of_plan_;
    pairs_.erase(pair_key(u, v));
    work_on(input_, *pair);
    while (pair->state != Pair::kDone) {
      if (!work_on(input_, *plan_)) pair->state.wait(Pair::kTaken);
    }
  }
  return pair->verdict ? std::move(*pair->verdict) : verify(input_, *pair);
}

Verification VerificationAhead::verify(const MergeInput& input, Pair& pair) {
  const auto prepared = [&input](Image& image, VertexId vertex) {
    const std::lock_guard lock(image.mutex);
    if (!image.prepared) image.prepared = input.verifier->prepare(input.appearances->appearances(vertex));
    return image.prepared;
  };
  const std::shared_ptr<const PreparedImage> of_u = prepared(*pair.of_u, pair.u), of_v = prepared(*pair.of_v, pair.v);
  return input.verifier->verify_prepared(*of_u, *of_v);
}

// False: somebody has it, or had it.
bool VerificationAhead::work_on(const MergeInput& input, Pair& pair) {
  std::uint8_t open = Pair::kOpen;
  if (!pair.state.compare_exchange_strong(open, Pair::kTaken)) return false;
  try {
    pair.verdict = verify(input, pair);
  } catch (const std::exception&) {
    // Its own turn will tell.
  }
  pair.state = Pair::kDone;
  pair.state.notify_all();
  return true;
}

// The next pair that nobody has; false when there is none.
bool VerificationAhead::work_on(const MergeInput& input, Plan& plan) {
  for (std::size_t i = plan.next++; i < plan.pairs.size(); i = plan.next++) {
    if (work_on(input, *plan.pairs[i])) return true;
  }
  return false;
}

std::shared_ptr<VerificationAhead::Image> VerificationAhead::image(VertexId vertex) {
  if (const auto found = images_.find(vertex); found != images_.end()) return found->second;
  if (images_.size() >= kMostPrepared) images_.clear();
  return images_.emplace(vertex, std::make_shared<Image>()).first->second;
}

std::shared_ptr<VerificationAhead::Pair> VerificationAhead::pair_of(VertexId u, VertexId v) {
  if (const auto found = pairs_.find(pair_key(u, v)); found != pairs_.end()) return found->second;
  auto pair = std::make_shared<Pair>();
  pair->u = std::min(u, v);
  pair->v = std::max(u, v);
  pair->of_u = image(pair->u);
  pair->of_v = image(pair->v);
  return pair;
}

void VerificationAhead::look_ahead(VertexId u, VertexId v, const Upcoming& upcoming) {
  const std::size_t begun = plan_->next, size = plan_->pairs.size();
  const bool is_expected = pairs_.contains(pair_key(u, v));
  // Not at every pair: a plan costs time too.
  if (begun < size && taken_of_plan_ < kTask) return;
  if (is_expected && begun < size / 2) return;
  ahead_ = is_expected ? std::min(2 * ahead_, kMostAhead) : std::max(ahead_ / 2, kLeastAhead);
  make_plan(u, v, upcoming);
}

void VerificationAhead::make_plan(VertexId u, VertexId v, const Upcoming& upcoming) {
  if (pairs_.size() > kMostKept) pairs_.clear();
  plan_->next = plan_->pairs.size();
  candidates_.assign(1, {u, v, 0});
  upcoming(ahead_ + 1, candidates_);  // the pair itself is most often among them
  auto plan = std::make_shared<Plan>();
  for (const Candidate& c : candidates_) {
    const std::shared_ptr<Pair> pair = pair_of(c.source, c.target);
    pairs_.emplace(pair_key(c.source, c.target), pair);
    if (pair->state == Pair::kOpen) plan->pairs.push_back(pair);
  }
  plan_ = std::move(plan);
  taken_of_plan_ = 0;
  if (plan_->pairs.size() < 2) return;
  if (!line_) line_ = input_.executor->open_line();
  for (std::size_t begin = 0; begin < plan_->pairs.size(); begin += kTask) {
    line_->submit([&input = input_, plan = plan_] {
      for (std::size_t i = 0; i < kTask && work_on(input, *plan); ++i) continue;
    });
  }
}

}  // namespace mapweld
