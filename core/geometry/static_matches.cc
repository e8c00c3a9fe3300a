#include "core/geometry/static_matches.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include "core/geometry/nearest_signatures.h"
#include "core/geometry/signature_matches.h"

namespace mapweld {
namespace {

// All features of an image, sorted: those that are known to be static, too.
class Whole {
 public:
  explicit Whole(const AppearanceVector& image) : all_(&image) {
    if (image.static_appearances.empty()) return;
    const std::vector<Appearance>& counting = image.appearances;
    const std::vector<Appearance>& fixed = image.static_appearances;
    merged_ = {image.width_px, image.height_px, {}};
    merged_.appearances.reserve(counting.size() + fixed.size());
    counts_.reserve(counting.size() + fixed.size());
    for (auto p = counting.begin(), q = fixed.begin(); p != counting.end() || q != fixed.end();) {
      const bool takes_counting = q == fixed.end() || (p != counting.end() && *p <= *q);
      merged_.appearances.push_back(takes_counting ? *p++ : *q++);
      counts_.push_back(takes_counting ? 1 : 0);
    }
    all_ = &merged_;
  }
  Whole(const Whole&) = delete;
  Whole& operator=(const Whole&) = delete;

  const AppearanceVector& image() const { return *all_; }
  // Whether nothing of it was set apart.
  bool is_as_it_came() const { return counts_.empty(); }
  // Whether a feature is among the image's appearances; they keep their order.
  bool counts(std::size_t i) const { return counts_.empty() || counts_[i] != 0; }

 private:
  const AppearanceVector* all_;
  AppearanceVector merged_;
  std::vector<std::uint8_t> counts_;
};

// Whether a feature of a and one of b are at the same place, with one frame laid over the other.
class SamePlace {
 public:
  SamePlace(const AppearanceVector& a, const AppearanceVector& b, const StaticMatchOptions& options)
      : across_(static_cast<float>(a.width_px) / static_cast<float>(b.width_px)),
        down_(static_cast<float>(a.height_px) / static_cast<float>(b.height_px)),
        reach_px_(options.max_displacement * diagonal(a)),
        by_signatures_(has_signatures(a) && has_signatures(b)),
        options_(options) {}

  // How far apart, at most, in pixels of a.
  float reach_px() const { return reach_px_; }
  float x_in_a(const Appearance& q) const { return q.x_px * across_; }
  float y_in_a(const Appearance& q) const { return q.y_px * down_; }

  bool operator()(const Appearance& p, const Appearance& q) const {
    return distance2(p, q) <= reach_px_ * reach_px_ && alike(p, q);
  }
  float distance2(const Appearance& p, const Appearance& q) const {
    const float dx = p.x_px - x_in_a(q);
    const float dy = p.y_px - y_in_a(q);
    return dx * dx + dy * dy;
  }
  bool alike(const Appearance& p, const Appearance& q) const {
    const float turn = std::fabs(p.angle_deg - q.angle_deg);
    if (std::min(turn, 360 - turn) > options_.max_turn_deg) return false;
    const float scale = q.scale_px * std::sqrt(across_ * down_);
    if (p.scale_px > options_.max_ratio * scale || scale > options_.max_ratio * p.scale_px) return false;
    if (!by_signatures_) return p.word == q.word;
    return hamming_distance(p.signature, q.signature) <= options_.max_distance;
  }

 private:
  static float diagonal(const AppearanceVector& image) {
    const auto width = static_cast<float>(image.width_px);
    const auto height = static_cast<float>(image.height_px);
    return std::sqrt(width * width + height * height);
  }

  float across_;
  float down_;
  float reach_px_;
  bool by_signatures_;
  StaticMatchOptions options_;
};

// Whether at least `few` features of equal words are at the same place: what is static has nearly always some of one
// word, and most pairs end here.
bool has_some(const AppearanceVector& a, const AppearanceVector& b, std::span<const CommonWord> common,
              const SamePlace& same_place, int few) {
  int found = 0;
  for (const CommonWord& word : common) {
    for (std::uint32_t i = word.a_begin; i < word.a_end; ++i) {
      for (std::uint32_t j = word.b_begin; j < word.b_end; ++j) {
        if (same_place(a.appearances[i], b.appearances[j]) && ++found >= few) return true;
      }
    }
  }
  return false;
}

// Frames to lay over each other, and features that 16 bits can number.
bool have_frames(const AppearanceVector& a, const AppearanceVector& b) {
  return a.width_px > 0 && a.height_px > 0 && b.width_px > 0 && b.height_px > 0 &&
         std::max(a.appearances.size(), b.appearances.size()) <= UINT16_MAX;
}

constexpr std::uint8_t kDisplaced = 1;  // it has a partner nearby
constexpr std::uint8_t kStatic = 2;     // it has one at the same place
struct Marks {
  std::vector<std::uint8_t> a, b;
  int count(std::uint8_t mark) const {
    return static_cast<int>(std::min(std::ranges::count(a, mark), std::ranges::count(b, mark)));
  }
};

// Rows of b's features, top to bottom, so that those near a place are found at once.
class Rows {
 public:
  Rows(const AppearanceVector& b, const SamePlace& same_place, float height_px)
      : rows_per_px_(kRows / std::max(height_px, 1.0f)) {
    std::vector<std::uint8_t> row(b.appearances.size());
    for (std::size_t j = 0; j < row.size(); ++j) {
      row[j] = static_cast<std::uint8_t>(row_of(same_place.y_in_a(b.appearances[j])));
      ++starts_[row[j] + 1u];
    }
    for (std::size_t r = 1; r < starts_.size(); ++r) starts_[r] += starts_[r - 1];
    features_.resize(row.size());
    auto next = starts_;
    for (std::size_t j = 0; j < row.size(); ++j) features_[next[row[j]]++] = static_cast<std::uint16_t>(j);
  }

  // Features in rows that a circle around `y_px` meets: [first, second) of features().
  std::pair<std::uint32_t, std::uint32_t> near(float y_px, float reach_px) const {
    return {starts_[static_cast<std::size_t>(row_of(y_px - reach_px))],
            starts_[static_cast<std::size_t>(row_of(y_px + reach_px)) + 1]};
  }
  std::uint16_t feature(std::uint32_t place) const { return features_[place]; }

 private:
  static constexpr int kRows = 120;
  int row_of(float y_px) const { return std::clamp(static_cast<int>(y_px * rows_per_px_), 0, kRows - 1); }

  float rows_per_px_;
  std::array<std::uint32_t, kRows + 1> starts_{};
  std::vector<std::uint16_t> features_;
};

Marks mark(const AppearanceVector& a, const AppearanceVector& b, const SamePlace& same_place,
           const StaticMatchOptions& options) {
  Marks marks;
  marks.a.resize(a.appearances.size());
  marks.b.resize(b.appearances.size());
  const Rows rows(b, same_place, static_cast<float>(a.height_px));
  const float reach_px = same_place.reach_px();
  const float near_px = reach_px / options.max_displacement * options.agreeing_displacement;
  for (std::size_t i = 0; i < marks.a.size(); ++i) {
    const Appearance& p = a.appearances[i];
    const auto [first, end] = rows.near(p.y_px, near_px);
    for (std::uint32_t place = first; place < end; ++place) {
      const std::uint16_t j = rows.feature(place);
      const Appearance& q = b.appearances[j];
      const float distance2 = same_place.distance2(p, q);
      if (distance2 > near_px * near_px || !same_place.alike(p, q)) continue;
      const std::uint8_t mark = distance2 <= reach_px * reach_px ? kStatic : kDisplaced;
      marks.a[i] = std::max(marks.a[i], mark);
      marks.b[j] = std::max(marks.b[j], mark);
    }
  }
  return marks;
}

constexpr int kAcross = 8;
constexpr int kDown = 6;
struct CellCounts {
  std::array<int, kAcross * kDown> all{};
  std::array<int, kAcross * kDown> marked{};

  void add(const AppearanceVector& image, const std::vector<std::uint8_t>& marks) {
    for (std::size_t i = 0; i < marks.size(); ++i) {
      const Appearance& p = image.appearances[i];
      const int x = std::clamp(static_cast<int>(p.x_px * kAcross / static_cast<float>(image.width_px)), 0, kAcross - 1);
      const int y = std::clamp(static_cast<int>(p.y_px * kDown / static_cast<float>(image.height_px)), 0, kDown - 1);
      const auto cell = static_cast<std::size_t>(y * kAcross + x);
      ++all[cell];
      marked[cell] += marks[i] != 0 ? 1 : 0;
    }
  }
};

bool is_same_view(const AppearanceVector& a, const AppearanceVector& b, const Marks& marks,
                  const StaticMatchOptions& options) {
  CellCounts cells;
  cells.add(a, marks.a);
  cells.add(b, marks.b);
  int occupied = 0;
  int agreeing = 0;
  for (std::size_t c = 0; c < cells.all.size(); ++c) {
    if (cells.all[c] == 0) continue;
    ++occupied;
    agreeing +=
        static_cast<float>(cells.marked[c]) >= options.agreeing_features * static_cast<float>(cells.all[c]) ? 1 : 0;
  }
  const auto agree = [&](int fewest, float share) {
    return agreeing >= fewest && static_cast<float>(agreeing) >= share * static_cast<float>(occupied);
  };
  return agree(options.fewest_cells, options.agreeing_cells) ||
         (marks.count(kDisplaced) >= std::max(options.displaced, marks.count(kStatic) / 8) &&
          agree(options.fewest_cells_displaced, options.agreeing_cells_displaced));
}

// The features around static ones are taken for static, too.
void mark_surroundings(const AppearanceVector& a, const AppearanceVector& b, const SamePlace& same_place,
                       const StaticMatchOptions& options, Marks& marks) {
  const float reach_px = same_place.reach_px() / options.max_displacement * options.surroundings;
  std::vector<std::pair<float, float>> centres;
  for (std::size_t i = 0; i < marks.a.size(); ++i) {
    if (marks.a[i] == kStatic) centres.emplace_back(a.appearances[i].x_px, a.appearances[i].y_px);
  }
  const auto near_a_centre = [&](float x, float y) {
    return std::ranges::any_of(centres, [&](const auto& c) {
      return (c.first - x) * (c.first - x) + (c.second - y) * (c.second - y) <= reach_px * reach_px;
    });
  };
  for (std::size_t i = 0; i < marks.a.size(); ++i) {
    if (marks.a[i] != kStatic && near_a_centre(a.appearances[i].x_px, a.appearances[i].y_px)) marks.a[i] = kStatic;
  }
  for (std::size_t j = 0; j < marks.b.size(); ++j) {
    const Appearance& q = b.appearances[j];
    if (marks.b[j] != kStatic && near_a_centre(same_place.x_in_a(q), same_place.y_in_a(q))) marks.b[j] = kStatic;
  }
}

void keep_unmarked(const Whole& whole, const std::vector<std::uint8_t>& marks, AppearanceVector& kept,
                   std::vector<std::uint16_t>& index) {
  const AppearanceVector& image = whole.image();
  std::uint16_t own_index = 0;  // among the appearances of the image as it came
  kept.width_px = image.width_px;
  kept.height_px = image.height_px;
  kept.appearances.reserve(marks.size());
  index.reserve(marks.size());
  for (std::size_t i = 0; i < marks.size(); ++i) {
    if (!whole.counts(i)) continue;
    if (marks[i] != kStatic) {
      kept.appearances.push_back(image.appearances[i]);
      index.push_back(own_index);
    }
    ++own_index;
  }
}

}  // namespace

std::vector<std::uint8_t> at_same_place(const AppearanceVector& image, const AppearanceVector& other,
                                        const StaticMatchOptions& options) {
  const Whole whole(other);
  if (!have_frames(image, whole.image())) return std::vector<std::uint8_t>(image.appearances.size(), 0);
  StaticMatchOptions narrow = options;
  narrow.agreeing_displacement = narrow.max_displacement;  // what is displaced is not asked for
  std::vector<std::uint8_t> found = mark(image, whole.image(), SamePlace(image, whole.image(), narrow), narrow).a;
  for (std::uint8_t& mark : found) mark = mark == kStatic ? 1 : 0;
  return found;
}

std::optional<WithoutStatic> without_static(const AppearanceVector& a, const AppearanceVector& b,
                                            const StaticMatchOptions& options) {
  return without_static(a, b, common_words(words_of(a), words_of(b)), options);
}

std::optional<WithoutStatic> without_static(const AppearanceVector& image_a, const AppearanceVector& image_b,
                                            std::span<const CommonWord> common, const StaticMatchOptions& options) {
  constexpr int kOfOneWord = 3;
  const Whole whole_a(image_a);
  const Whole whole_b(image_b);
  std::vector<CommonWord> of_wholes;
  if (!whole_a.is_as_it_came() || !whole_b.is_as_it_came()) {
    of_wholes = common_words(words_of(whole_a.image()), words_of(whole_b.image()));
    common = of_wholes;
  }
  const AppearanceVector& a = whole_a.image();
  const AppearanceVector& b = whole_b.image();
  if (!have_frames(a, b)) return std::nullopt;
  const SamePlace same_place(a, b, options);
  if (!has_some(a, b, common, same_place, std::min(kOfOneWord, options.few))) return std::nullopt;
  Marks marks = mark(a, b, same_place, options);
  if (marks.count(kStatic) < options.few || is_same_view(a, b, marks, options)) return std::nullopt;
  mark_surroundings(a, b, same_place, options, marks);
  WithoutStatic rest;
  keep_unmarked(whole_a, marks.a, rest.a, rest.index_a);
  keep_unmarked(whole_b, marks.b, rest.b, rest.index_b);
  return rest;
}

}  // namespace mapweld
