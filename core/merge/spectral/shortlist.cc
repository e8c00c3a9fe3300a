#include "core/merge/spectral/shortlist.h"

#include <algorithm>
#include <array>
#include <bit>
#include <limits>

namespace mapweld {
namespace {

// A rough score is wrong by less than this share (four times what roundings can add up to), above kLeastRough.
constexpr float kMargin = 1e-3F, kLeastRough = 1e-30F;

float rough_square_of_logistic(float x) {
  x = x < -12 ? -12.0F : x;
  x = x > 12 ? 12.0F : x;
  float e = 1 - x / 1024;
  for (int i = 0; i < 10; ++i) e *= e;
  const float chance = 1 / (1 + e);
  return chance * chance;
}

class Scores {
 public:
  explicit Scores(const ScoreBasis& basis)
      : basis_(basis), evidence_(basis.evidence), rough_(evidence_.size()), components_(basis.join.vertices) {
    for (std::uint32_t v = 0; v < components_.size(); ++v) {
      const std::uint32_t component = basis.gain.component(VertexId{v});
      components_[v] = {component, basis.gain.is_embedded(VertexId{v}),
                        basis.join.of(basis.gain.component_size(component))};
    }
    for (std::uint32_t row = 0; row < evidence_.rows(); ++row) score_row(row);
    scale_ = best_ > 0 ? best_chance_ / best_ : 0;
  }

  // Those with the best ones, of more that are open.
  std::vector<std::uint32_t> best(std::size_t count) {
    const auto [low, high] = threshold(count);
    std::vector<std::uint32_t> taken;
    taken.reserve(count);
    std::vector<Scored> doubtful;
    for (std::uint32_t c = 0; c < evidence_.size(); ++c) {
      if (!evidence_.is_open(c) || rough_[c] < low) continue;
      if (rough_[c] >= high) {
        taken.push_back(c);
      } else {
        doubtful.push_back({score(c), c});
      }
    }
    const std::size_t rest = count - taken.size();
    if (rest < doubtful.size()) {
      std::nth_element(doubtful.begin(), doubtful.begin() + static_cast<std::ptrdiff_t>(rest), doubtful.end());
      doubtful.resize(rest);
    }
    const auto sure = static_cast<std::ptrdiff_t>(taken.size());
    for (const Scored& s : doubtful) taken.push_back(s.candidate);
    std::sort(taken.begin() + sure, taken.end());
    std::inplace_merge(taken.begin(), taken.begin() + sure, taken.end());
    return taken;
  }

 private:
  struct Component {
    std::uint32_t number = 0;
    bool is_embedded = false;
    double join_worth = 0;  // with one that is not smaller
  };
  struct Scored {
    double score = 0;
    std::uint32_t candidate = 0;
    // Of two the one that is taken first.
    bool operator<(const Scored& o) const { return score != o.score ? score > o.score : candidate < o.candidate; }
  };

  VertexId source(std::uint32_t c) const { return basis_.sources[evidence_.cell(c).row]; }
  VertexId target(std::uint32_t c) const { return basis_.targets[evidence_.cell(c).column]; }
  double square_of_chance(std::uint32_t c) const {
    const double chance = basis_.model.chance(evidence_.features(c));
    return chance * chance;
  }
  static double worth(const Component& a, const Component& b) {
    return a.number != b.number ? std::min(a.join_worth, b.join_worth) : kWorthElsewhere;
  }

  double score(std::uint32_t c) const {
    const Component &a = components_[to_index(source(c))], &b = components_[to_index(target(c))];
    const double chance = square_of_chance(c);
    if (a.is_embedded && b.is_embedded) return chance * basis_.gain.first_gain(source(c), target(c)) * scale_;
    return chance * worth(a, b);
  }

  // Block by block, so that chances are worked out several at once. Scores of strengthening ones are not scaled yet,
  // and negative.
  void score_row(std::uint32_t row) {
    const VertexId u = basis_.sources[row];
    const Component& a = components_[to_index(u)];
    std::uint32_t c = evidence_.first_of(row);
    const std::uint32_t end = evidence_.first_of(row + 1);
    while (c < end) {
      std::size_t n = 0;
      for (; c < end && n < kBlock; ++c) {
        if (!evidence_.is_open(c)) continue;
        const VertexId v = target(c);
        const Component& b = components_[to_index(v)];
        block_.candidates[n] = c;
        block_.scores[n] = basis_.model.log_odds(evidence_.features(c));
        block_.worths[n] =
            static_cast<float>(a.is_embedded && b.is_embedded ? -basis_.gain.first_gain(u, v) : worth(a, b));
        ++n;
      }
      for (std::size_t i = 0; i < n; ++i) {
        block_.scores[i] = block_.worths[i] * rough_square_of_logistic(block_.scores[i]);
      }
      for (std::size_t i = 0; i < n; ++i) {
        rough_[block_.candidates[i]] = block_.scores[i];
        if (-block_.scores[i] > least_best_) note_best(block_.candidates[i]);
      }
    }
  }

  void note_best(std::uint32_t c) {
    const double chance = square_of_chance(c), score = chance * basis_.gain.first_gain(source(c), target(c));
    if (score <= best_) return;
    best_ = score;
    best_chance_ = chance;
    least_best_ = static_cast<float>(best_) * (1 - kMargin);
  }

  struct Range {
    float low, high;
  };
  // Whose rough score is `high` or more is certainly among the best `count`, whose is below `low` certainly not.
  Range threshold(std::size_t count) {
    constexpr int kShift = 15;  // buckets of 1/256
    std::vector<std::uint32_t> in_bucket(
        (std::bit_cast<std::uint32_t>(std::numeric_limits<float>::infinity()) >> kShift) + 1);
    for (std::uint32_t c = 0; c < evidence_.size(); ++c) {
      if (!evidence_.is_open(c)) continue;
      float& rough = rough_[c];
      if (std::signbit(rough)) rough = static_cast<float>(-rough * scale_);
      ++in_bucket[std::bit_cast<std::uint32_t>(rough) >> kShift];
    }
    std::uint32_t bucket = static_cast<std::uint32_t>(in_bucket.size() - 1);
    for (std::size_t above = in_bucket[bucket]; above < count; above += in_bucket[bucket]) --bucket;
    const auto low = std::bit_cast<float>(bucket << kShift), high = std::bit_cast<float>((bucket + 1) << kShift);
    return {low < kLeastRough ? 0 : low * (1 - 3 * kMargin), std::max(high, kLeastRough) * (1 + 3 * kMargin)};
  }

  static constexpr std::size_t kBlock = 256;
  struct Block {
    std::array<std::uint32_t, kBlock> candidates;
    std::array<float, kBlock> scores, worths;
  };

  const ScoreBasis& basis_;
  const CandidateEvidence& evidence_;
  std::vector<float> rough_;           // by candidate
  std::vector<Component> components_;  // by vertex
  double best_ = 0, best_chance_ = 0;  // the best chance^2 x gain; its chance^2
  float least_best_ = 0;               // a rough score that might be better
  double scale_ = 0;                   // of gains
  Block block_;
};

}  // namespace

std::vector<std::uint32_t> draw_shortlist(const ScoreBasis& basis, std::size_t count) {
  if (count < basis.evidence.open()) return Scores(basis).best(count);
  std::vector<std::uint32_t> all;
  all.reserve(basis.evidence.open());
  for (std::uint32_t c = 0; c < basis.evidence.size(); ++c) {
    if (basis.evidence.is_open(c)) all.push_back(c);
  }
  return all;
}

}  // namespace mapweld
