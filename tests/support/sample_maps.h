// Two robots' images of one building, with queries and truth: what the demonstration and most tests run on.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "tests/support/rendered_world.h"
#include "tests/support/shared_view.h"
#include "tests/support/trajectory.h"

namespace mapweld::rendered {

// A building in which two drives of these lengths overlap (two_robots).
WorldOptions world_for_maps(int n_images_a, int n_images_b, std::uint64_t seed, bool look_alike = false);

// The two robots' cameras: a's sees a bright afternoon; b's a dull evening, a little darker, warmer and noisier.
CameraConditions conditions_of_a();
CameraConditions conditions_of_b();
// Neither: what a visitor with a third camera sees.
CameraConditions conditions_of_queries();

// JPEG bytes of an image, quality 1..100. Throws std::runtime_error if OpenCV cannot.
std::vector<std::uint8_t> to_jpeg(const cv::Mat& bgr, int quality = 95);

// One robot's images, in the order in which it took them.
struct SampleMap {
  std::vector<Pose> poses;
  std::vector<ViewRecord> views;
  std::vector<std::vector<std::uint8_t>> jpegs;
  std::size_t size() const { return poses.size(); }
};

struct SampleMaps {
  SampleMap a;
  SampleMap b;
  SampleMap queries;  // in neither map
};

struct SampleMapsOptions {
  int n_images_a = 60;
  int n_images_b = 40;
  int n_queries = 10;
  std::uint64_t seed = 1;
  bool look_alike = false;
  int threads = 1;
  friend auto operator<=>(const SampleMapsOptions&, const SampleMapsOptions&) = default;
};

// Renders in memory. The same for any number of threads.
SampleMaps render_sample_maps(const SampleMapsOptions& options);

// The same, once per process: later calls with equal options return the same object. Any thread may call it.
//
//   const SampleMaps& maps = small_world_pair(30, 20);
//   mapper.insert(maps.a.jpegs[0]) ...; EXPECT_GT(shared_view(maps.a.views[i], maps.b.views[j]), 0.05);
const SampleMaps& small_world_pair(int n_images_a = 60, int n_images_b = 40, int n_queries = 10,
                                   std::uint64_t seed = 1);

}  // namespace mapweld::rendered
