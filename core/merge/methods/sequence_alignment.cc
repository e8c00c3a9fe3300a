#include "core/merge/methods/sequence_alignment.h"

#include <algorithm>
#include <functional>
#include <stdexcept>
#include <tuple>
#include <utility>

namespace mapweld {

SequenceAligner::SequenceAligner(std::uint32_t rows, std::vector<ScoredPair> pairs,
                                 const SequenceAlignmentOptions& options)
    : options_(options), pairs_(std::move(pairs)), is_removed_(pairs_.size(), false) {
  if (options.max_step < 1 || options.min_score < 1 || options.max_pairs < 1 || options.skip_penalty < 0 ||
      options.repeat_penalty < 0) {
    throw std::invalid_argument("options of an alignment are out of range");
  }
  offsets_.assign(std::size_t{rows} + 1, 0);
  for (std::size_t k = 0; k < pairs_.size(); ++k) {
    const ScoredPair& pair = pairs_[k];
    const bool in_order = k == 0 || std::tie(pairs_[k - 1].row, pairs_[k - 1].column) < std::tie(pair.row, pair.column);
    if (pair.row >= rows || pair.score <= 0 || !in_order) {
      throw std::invalid_argument("pairs to align are not in order or have no score");
    }
    ++offsets_[pair.row + 1];
  }
  for (std::uint32_t row = 0; row < rows; ++row) offsets_[row + 1] += offsets_[row];
  for (Direction& d : directions_) {
    d.h.assign(pairs_.size(), 0);
    d.from.assign(pairs_.size(), kNone);
    d.queued.assign(pairs_.size(), 0);
  }
}

std::uint32_t SequenceAligner::turn(std::uint32_t pair, bool is_reversed) const {
  if (!is_reversed) return pair;
  const std::uint32_t row = pairs_[pair].row;
  return offsets_[row] + offsets_[row + 1] - 1 - pair;
}

template <typename Visit>
void SequenceAligner::visit_window(std::uint32_t pair, bool is_reversed, bool is_after, Visit&& visit) const {
  const auto [row, column, score] = pairs_[pair];
  const auto rows = static_cast<std::uint32_t>(offsets_.size() - 1);
  // Earlier pairs have lower columns, unless the columns run backwards; later ones the other way round.
  const bool is_left = is_reversed == is_after;
  const std::uint32_t low = is_left ? column - std::min(column, options_.max_step) : column;
  const std::uint32_t high = is_left ? column : column + std::min(kNone - column, options_.max_step);
  for (std::uint32_t a = 0; a <= options_.max_step; ++a) {
    if (is_after ? a >= rows - row : a > row) break;
    const std::uint32_t other = is_after ? row + a : row - a;
    const auto end = pairs_.begin() + offsets_[other + 1];
    auto at = std::lower_bound(pairs_.begin() + offsets_[other], end, low,
                               [](const ScoredPair& p, std::uint32_t c) { return p.column < c; });
    for (; at != end && at->column <= high; ++at) {
      const auto k = static_cast<std::uint32_t>(at - pairs_.begin());
      if (k != pair && !is_removed_[k]) visit(k, a, is_left ? column - at->column : at->column - column);
    }
  }
}

bool SequenceAligner::compute(std::uint32_t pair, bool is_reversed) {
  Direction& d = directions_[is_reversed];
  std::int64_t best = 0;
  std::uint32_t from = kNone;
  std::pair<std::uint32_t, std::uint32_t> distance;  // (a + b, a) of `from`
  visit_window(pair, is_reversed, false, [&](std::uint32_t before, std::uint32_t a, std::uint32_t b) {
    const std::int64_t skipped = (a > 1 ? a - 1 : 0) + (b > 1 ? b - 1 : 0);
    const std::int64_t value =
        d.h[before] - skipped * options_.skip_penalty - (a == 0 || b == 0 ? options_.repeat_penalty : 0);
    if (value <= 0 || value < best) return;
    const std::pair<std::uint32_t, std::uint32_t> here{a + b, a};
    if (value > best || here < distance) {
      best = value;
      from = before;
      distance = here;
    }
  });
  const std::int64_t h = pairs_[pair].score + best;
  d.from[pair] = from;
  if (h == d.h[pair]) return false;
  d.h[pair] = h;
  if (h >= options_.min_score) ends_.push({h, is_reversed, pair});
  return true;
}

bool SequenceAligner::prepare(std::uint64_t pairs) {
  const std::uint64_t all = pairs_.size();
  for (; pairs > 0 && computed_ < 2 * all; --pairs, ++computed_) {
    const bool is_reversed = computed_ >= all;
    compute(turn(static_cast<std::uint32_t>(is_reversed ? computed_ - all : computed_), is_reversed), is_reversed);
  }
  return computed_ == 2 * all;
}

std::optional<SequenceAlignment> SequenceAligner::best() {
  if (computed_ != 2 * pairs_.size()) throw std::logic_error("alignments are asked for before they are computed");
  while (!ends_.empty()) {
    const End end = ends_.top();
    const Direction& d = directions_[end.is_reversed];
    if (d.h[end.pair] != end.score) {  // stale; what is removed has 0
      ends_.pop();
      continue;
    }
    SequenceAlignment alignment;
    alignment.is_reversed = end.is_reversed;
    std::uint32_t first = end.pair;
    for (std::uint32_t k = end.pair; k != kNone && alignment.pairs.size() < options_.max_pairs; k = d.from[k]) {
      alignment.pairs.push_back(pairs_[k]);
      first = k;
    }
    std::ranges::reverse(alignment.pairs);
    alignment.score = end.score - (d.h[first] - pairs_[first].score);
    return alignment;
  }
  return std::nullopt;
}

std::uint32_t SequenceAligner::find(Position position) const {
  if (std::size_t{position.row} + 1 >= offsets_.size()) return kNone;
  const auto end = pairs_.begin() + offsets_[position.row + 1];
  const auto at = std::lower_bound(pairs_.begin() + offsets_[position.row], end, position.column,
                                   [](const ScoredPair& p, std::uint32_t c) { return p.column < c; });
  return at != end && at->column == position.column ? static_cast<std::uint32_t>(at - pairs_.begin()) : kNone;
}

void SequenceAligner::remove(std::span<const Position> positions) {
  std::vector<std::uint32_t> removed;
  for (const Position& position : positions) {
    const std::uint32_t pair = find(position);
    if (pair == kNone || is_removed_[pair]) continue;
    is_removed_[pair] = true;
    removed.push_back(pair);
  }
  for (const bool is_reversed : {false, true}) update(is_reversed, removed);
}

void SequenceAligner::update(bool is_reversed, std::span<const std::uint32_t> removed) {
  Direction& d = directions_[is_reversed];
  // In the order in which H is computed: then each pair is computed once, after all that come before it.
  std::priority_queue<std::uint32_t, std::vector<std::uint32_t>, std::greater<>> turns;
  const auto enqueue_after = [&](std::uint32_t pair) {
    visit_window(pair, is_reversed, true, [&](std::uint32_t after, std::uint32_t, std::uint32_t) {
      if (std::exchange(d.queued[after], 1) == 0) turns.push(turn(after, is_reversed));
    });
  };
  for (const std::uint32_t pair : removed) {
    d.h[pair] = 0;
    enqueue_after(pair);
  }
  while (!turns.empty()) {
    const std::uint32_t pair = turn(turns.top(), is_reversed);
    turns.pop();
    d.queued[pair] = 0;
    if (compute(pair, is_reversed)) enqueue_after(pair);
  }
}

std::vector<std::uint32_t> spread_order(std::uint32_t n) {
  std::vector<std::uint32_t> order;
  order.reserve(n);
  if (n > 0) order.push_back(0);
  if (n > 1) order.push_back(n - 1);
  std::queue<std::pair<std::uint32_t, std::uint32_t>> gaps;  // both ends are in the order already
  if (n > 2) gaps.emplace(0, n - 1);
  while (!gaps.empty()) {
    const auto [low, high] = gaps.front();
    gaps.pop();
    const std::uint32_t middle = low + (high - low) / 2;
    order.push_back(middle);
    if (middle - low > 1) gaps.emplace(low, middle);
    if (high - middle > 1) gaps.emplace(middle, high);
  }
  return order;
}

}  // namespace mapweld
