// How right the relative poses of verified pairs are: the figures of docs/verification.md, "How the cameras stand".
//
//   pose_accuracy [--seeds 401,402] [--images-a 60] [--images-b 40] [--size 320] [--csv]
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <optional>
#include <vector>

#include <CLI/CLI.hpp>

#include "core/geometry/pose/relative_pose.h"
#include "tests/support/posed_pairs.h"

namespace mapweld::rendered {
namespace {

double quantile(std::vector<double> values, double share) {
  if (values.empty()) return 0;
  std::ranges::sort(values);
  return values[static_cast<std::size_t>(share * static_cast<double>(values.size() - 1))];
}

int run(int argc, char** argv) {
  CLI::App app("How right the relative poses of verified pairs are");
  std::vector<std::uint64_t> seeds{401, 402};
  PosedPairsOptions options;
  int width_px = 320;
  bool csv = false;
  RelativePoseOptions how;
  app.add_option("--seeds", seeds)->delimiter(',');
  app.add_option("--images-a", options.n_images_a);
  app.add_option("--images-b", options.n_images_b);
  app.add_option("--size", width_px);
  app.add_option("--min-deviation", how.min_deviation);
  app.add_option("--max-sigma", how.max_sigma_deg);
  app.add_option("--doubt", how.doubt);
  app.add_flag("--csv", csv, "a line a pair");
  CLI11_PARSE(app, argc, argv);
  options.threads = 2;
  options.camera = {.width_px = width_px, .height_px = width_px * 3 / 4, .focal_px = 228.0 * width_px / 320};
  const Camera camera = camera_of(options.camera);

  std::vector<double> rotation_deg, direction_deg, turned_deg, took_ms;
  int pairs = 0, none = 0, turns = 0, turns_told = 0, moves = 0, moves_told = 0;
  if (csv)
    std::puts(
        "seed,kind,matches,inliers,shared,distance_m,told,deviation,sigma,parallax_deg,rotation_deg,direction_deg");
  for (const std::uint64_t seed : seeds) {
    options.seed = seed;
    for (const PosedPair& pair : posed_pairs(options)) {
      if (pair.shared < 0.02) continue;
      ++pairs;
      const auto begin = std::chrono::steady_clock::now();
      const auto pose = relative_pose(*pair.a, camera, *pair.b, camera, pair.verification.inlier_matches, how);
      took_ms.push_back(std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - begin).count());
      const bool moved = pair.truth.distance_m > 0.02;
      ++(moved ? moves : turns);
      double off_rotation = -1, off_direction = -1;
      if (!pose) {
        ++none;
      } else {
        off_rotation = angle_deg(pose->rotation, pair.truth.rotation);
        (pose->direction ? rotation_deg : turned_deg).push_back(off_rotation);
        if (pose->direction) {
          ++(moved ? moves_told : turns_told);
          if (moved) direction_deg.push_back(off_direction = angle_deg(*pose->direction, *pair.truth.direction));
        }
      }
      if (csv) {
        std::printf("%llu,%d,%d,%d,%.3f,%.3f,%d,%.2f,%.2f,%.2f,%.2f,%.2f\n", static_cast<unsigned long long>(seed),
                    static_cast<int>(pair.verification.kind), static_cast<int>(pair.verification.inlier_matches.size()),
                    pose ? pose->inliers : 0, pair.shared, pair.truth.distance_m, pose ? (pose->direction ? 2 : 1) : 0,
                    pose ? pose->deviation : 0, pose ? pose->sigma_deg : 0, pose ? pose->parallax_deg : 0, off_rotation,
                    off_direction);
      }
    }
  }
  if (csv) return 0;
  const auto line = [](const char* what, const std::vector<double>& values) {
    std::printf("%-42s %6zu  %7.2f %7.2f %7.2f\n", what, values.size(), quantile(values, 0.5), quantile(values, 0.9),
                quantile(values, 0.99));
  };
  std::printf("%d pairs: %d moved, of %d the direction is told; %d turned only, of %d it is told; no pose of %d\n",
              pairs, moves, moves_told, turns, turns_told, none);
  std::printf("%-42s %6s  %7s %7s %7s\n", "", "pairs", "50 %", "90 %", "99 %");
  line("rotation, off by deg, direction told", rotation_deg);
  line("rotation, off by deg, direction not told", turned_deg);
  line("direction, off by deg", direction_deg);
  line("milliseconds", took_ms);
  return 0;
}

}  // namespace
}  // namespace mapweld::rendered

int main(int argc, char** argv) { return mapweld::rendered::run(argc, argv); }
