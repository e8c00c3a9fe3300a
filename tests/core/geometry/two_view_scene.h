// Two views of a made scene, with the truth about every match: points in space with a word, a size and an orientation,
// seen by two pinhole cameras.
#pragma once

#include <array>
#include <cstdint>
#include <set>
#include <utility>

#include "core/types.h"

namespace mapweld::test {

struct SceneOptions {
  std::uint64_t seed = 1;
  int points = 80;          // seen by both cameras
  int outliers = 20;        // words that both images have, at unrelated places
  int clutter = 100;        // features of each image with words that the other has not
  int repeats = 0;          // words that appear two or three times in both images
  double noise_px = 0.3;    // of positions, standard deviation
  double nearest_m = 2;     // depths of the points ...
  double furthest_m = 8;    // ... spread between these
  bool flat = false;        // all points on one slanted plane
  double forward_m = 0.5;   // the second camera went so far along the axis of the first,
  double sideways_m = 0.3;  // so far to the right,
  double pan_deg = 5;       // turned to the right,
  double roll_deg = 0;      // and around its axis
  double scale_b = 1;       // the second image is so many times larger
  std::uint32_t first_word = 0;
};

struct TwoViewScene {
  AppearanceVector a;
  AppearanceVector b;
  std::array<double, 9> fundamental{};  // x_b^T F x_a = 0, pixels, norm 1; zero without translation
  std::array<double, 9> homography{};   // x_b ~ H x_a, pixels; for flat scenes and pure turns
  std::set<std::pair<std::uint16_t, std::uint16_t>> true_matches;  // indices into the appearances
};

TwoViewScene make_scene(const SceneOptions& options);

// Two images with `matches` common words at unrelated places.
enum class Layout : std::uint8_t { kUniform, kGrid, kShelves, kCluster };
struct ChanceOptions {
  std::uint64_t seed = 1;
  int matches = 100;
  Layout layout = Layout::kUniform;
  bool equal_frames = true;  // all features have one scale and angle, as if only positions could contradict
};
std::pair<AppearanceVector, AppearanceVector> make_chance_pair(const ChanceOptions& options);

// Distance in pixels of b's point from the epipolar line of a's.
double epipolar_distance_px(const std::array<double, 9>& f, const Appearance& a, const Appearance& b);
// Distance in pixels of b's point from where `h` sends a's.
double transfer_distance_px(const std::array<double, 9>& h, const Appearance& a, const Appearance& b);

}  // namespace mapweld::test
