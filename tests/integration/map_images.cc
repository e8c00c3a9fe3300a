#include "tests/integration/map_images.h"

#include <chrono>
#include <cstdlib>
#include <map>
#include <mutex>
#include <thread>
#include <tuple>

#include <gtest/gtest.h>
#include <opencv2/imgcodecs.hpp>

#include "client/upload.h"
#include "tests/support/rendered_world.h"
#include "tests/support/trajectory.h"

namespace mapweld::testing {
namespace {

Images encode(const rendered::RenderedWorld& world, const std::vector<rendered::Pose>& poses,
              rendered::CameraConditions conditions) {
  Images images(poses.size());
  const auto render_share = [&](std::size_t first) {
    for (std::size_t i = first; i < poses.size(); i += 2) {
      rendered::CameraConditions at = conditions;
      at.noise_seed = conditions.noise_seed + i;
      std::vector<std::uint8_t> bytes;
      cv::imencode(".jpg", world.render(poses[i], at).bgr, bytes, {cv::IMWRITE_JPEG_QUALITY, 95});
      const std::string number = std::to_string(i);
      images[i] = {std::string(6 - number.size(), '0') + number + ".jpg", std::string(bytes.begin(), bytes.end())};
    }
  };
  std::thread other(render_share, 1);
  render_share(0);
  other.join();
  return images;
}

}  // namespace

const RobotPair& rendered_pair(int n_images_a, int n_images_b, std::uint64_t seed) {
  static std::mutex mutex;
  static std::map<std::tuple<int, int, std::uint64_t>, RobotPair> made;
  const std::lock_guard lock(mutex);
  auto [place, is_new] = made.try_emplace({n_images_a, n_images_b, seed});
  if (is_new) {
    rendered::WorldOptions building;
    building.corridors = 1;
    building.seed = seed;
    const rendered::RenderedWorld world(building);
    const auto drives = rendered::two_robots(world, n_images_a, n_images_b, seed);
    rendered::CameraConditions conditions;
    conditions.noise_seed = 1'000'000;
    place->second.a = encode(world, rendered::trajectory(world, drives.a), conditions);
    conditions = {};
    conditions.noise_seed = 2'000'000;
    conditions.gain = 1.1;
    conditions.warmth = 0.3;
    place->second.b = encode(world, rendered::trajectory(world, drives.b), conditions);
  }
  return place->second;
}

std::optional<std::filesystem::path> photographs(const std::string& data_set) {
  const char* set = std::getenv("MAPWELD_PHOTOS");
  const std::filesystem::path root = set != nullptr && *set != '\0' ? set : MAPWELD_SOURCE_DIR "/../shared/data";
  if (!std::filesystem::is_directory(root / data_set)) return std::nullopt;
  return root / data_set;
}

void upload(client::Client& client, const std::string& map, const Images& images,
            std::optional<contract::MapParameters> parameters) {
  contract::CreateMap request;
  request.name = map;
  request.parameters = std::move(parameters);
  client.create_map(request);
  for (std::size_t first = 0; first < images.size(); first += contract::kMaxBatchImages) {
    const std::size_t last = std::min(images.size(), first + contract::kMaxBatchImages);
    const auto answer = client.upload_batch(map, Images(images.begin() + static_cast<std::ptrdiff_t>(first),
                                                        images.begin() + static_cast<std::ptrdiff_t>(last)));
    for (const auto& item : answer->items) {
      if (const auto* problem = std::get_if<contract::Problem>(&item)) ADD_FAILURE() << problem->detail;
    }
  }
}

void upload_folder(client::Client& client, const std::string& map, const std::filesystem::path& folder, int threads) {
  contract::CreateMap request;
  request.name = map;
  client.create_map(request);
  client::UploadOptions options;
  options.map = map;
  options.directory = folder;
  options.threads = threads;
  const auto report = client::upload_directory(client, options);
  EXPECT_EQ(report.refused, 0) << folder;
  EXPECT_EQ(report.inserted + report.ignored, report.files) << folder;
}

contract::Merge wait_for(client::Client& client, std::int64_t merge, double timeout_s) {
  const auto deadline = std::chrono::steady_clock::now() + std::chrono::duration<double>(timeout_s);
  while (true) {
    auto now = *client.merge(merge);
    if (contract::is_at_rest(now.state)) return now;
    if (std::chrono::steady_clock::now() > deadline) {
      ADD_FAILURE() << "merge " << merge << " is still " << now.state << " after " << timeout_s << " s";
      return now;
    }
    std::this_thread::sleep_for(std::chrono::milliseconds(3));
  }
}

contract::Merge merge(client::Client& client, const std::string& a, const std::string& b, const std::string& name,
                      const std::string& method) {
  contract::SubmitMerge request;
  request.maps = {a, b};
  request.name = name;
  request.method = method;
  return wait_for(client, client.submit_merge(request)->id);
}

}  // namespace mapweld::testing
