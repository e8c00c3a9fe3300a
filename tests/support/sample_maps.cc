#include "tests/support/sample_maps.h"

#include <algorithm>
#include <map>
#include <mutex>
#include <stdexcept>
#include <tuple>

#include <opencv2/imgcodecs.hpp>

#include "tests/support/rendering/parallel.h"
#include "tests/support/rendering/repeatable.h"

namespace mapweld::rendered {
namespace {

SampleMap render_map(const RenderedWorld& world, const std::vector<Pose>& poses, const CameraConditions& conditions,
                     std::uint64_t noise_seed, int threads) {
  SampleMap map;
  map.poses = poses;
  map.views = view_records(world, poses, threads);
  map.jpegs.resize(poses.size());
  for_each_index(static_cast<int>(poses.size()), threads, [&](int i) {
    CameraConditions own = conditions;
    own.noise_seed = hash_of(noise_seed, i);
    const auto index = static_cast<std::size_t>(i);
    map.jpegs[index] = to_jpeg(world.render(poses[index], own).bgr);
  });
  return map;
}

}  // namespace

WorldOptions world_for_maps(int n_images_a, int n_images_b, std::uint64_t seed, bool look_alike) {
  // A lap takes some nine images for every metre of corridor, visits to rooms included.
  const double needed_m = std::max(24.0, (n_images_a + 0.25 * n_images_b) / 8.5);
  WorldOptions options;
  options.corridors = std::clamp(static_cast<int>(needed_m / 26 + 0.999), 2, 64);
  options.corridor_length_m = std::clamp(needed_m / options.corridors, 12.0, 60.0);
  options.look_alike_corridors = look_alike ? 0.9 : 0.0;
  options.seed = seed;
  return options;
}

CameraConditions conditions_of_a() { return {}; }

CameraConditions conditions_of_b() {
  CameraConditions conditions;
  conditions.lamps = 0.80;
  conditions.daylight = 0.15;
  conditions.gain = 1.08;
  conditions.gamma = 1.08;
  conditions.warmth = 0.45;
  conditions.vignetting = 0.3;
  conditions.noise_sigma = 2.2;
  return conditions;
}

CameraConditions conditions_of_queries() {
  CameraConditions conditions;
  conditions.lamps = 0.82;
  conditions.daylight = 0.35;
  conditions.gamma = 0.94;
  conditions.warmth = -0.4;
  conditions.noise_sigma = 2.2;
  return conditions;
}

std::vector<std::uint8_t> to_jpeg(const cv::Mat& bgr, int quality) {
  std::vector<std::uint8_t> bytes;
  if (!cv::imencode(".jpg", bgr, bytes, {cv::IMWRITE_JPEG_QUALITY, quality})) {
    throw std::runtime_error("OpenCV cannot write JPEG");
  }
  return bytes;
}

SampleMaps render_sample_maps(const SampleMapsOptions& options) {
  const RenderedWorld world(world_for_maps(options.n_images_a, options.n_images_b, options.seed, options.look_alike));
  const TwoRobots robots = two_robots(world, options.n_images_a, options.n_images_b, options.seed);
  const std::vector<Pose> a = trajectory(world, robots.a);
  const std::vector<Pose> b = trajectory(world, robots.b);
  std::vector<Pose> driven = a;
  driven.insert(driven.end(), b.begin(), b.end());
  std::vector<Pose> queries;
  if (options.n_queries > 0) queries = query_poses(world, driven, options.n_queries, options.seed);
  SampleMaps maps;
  maps.a = render_map(world, a, conditions_of_a(), hash_of(options.seed, 1), options.threads);
  maps.b = render_map(world, b, conditions_of_b(), hash_of(options.seed, 2), options.threads);
  maps.queries = render_map(world, queries, conditions_of_queries(), hash_of(options.seed, 3), options.threads);
  return maps;
}

const SampleMaps& small_world_pair(int n_images_a, int n_images_b, int n_queries, std::uint64_t seed) {
  static std::mutex mutex;
  static std::map<std::tuple<int, int, int, std::uint64_t>, SampleMaps> cache;
  const std::lock_guard lock(mutex);
  const auto key = std::make_tuple(n_images_a, n_images_b, n_queries, seed);
  const auto found = cache.find(key);
  if (found != cache.end()) return found->second;
  SampleMapsOptions options;
  options.n_images_a = n_images_a;
  options.n_images_b = n_images_b;
  options.n_queries = n_queries;
  options.seed = seed;
  return cache.emplace(key, render_sample_maps(options)).first->second;
}

}  // namespace mapweld::rendered
