// What an uploaded image costs, stage by stage, on maps of two sizes: the table of docs/benchmarks.md.
//
//   image_stages [SMALL LARGE]     500 and 1,356 vertices unless said otherwise
//
// Renders a robot's drive (320x240), keeps the JPEG files in memory, and uploads them one by one, on one core, through
// the server's own use case into a store on disk. Medians are of the hundred uploads that follow each size.
#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <vector>

#include <opencv2/core/utility.hpp>
#include <opencv2/imgcodecs.hpp>

#include "core/feature/allocation.h"
#include "server/maps/map_cache.h"
#include "server/services/image_service.h"
#include "server/services/map_service.h"
#include "tests/support/rendered_world.h"
#include "tests/support/temp_store.h"
#include "tests/support/trajectory.h"

namespace mapweld {
namespace {

using Bytes = std::vector<std::uint8_t>;

std::vector<Bytes> render_drive(int images) {
  rendered::WorldOptions building;
  building.corridors = 3;
  building.corridor_length_m = 30;
  building.seed = 11;
  const rendered::RenderedWorld world(building);
  rendered::TrajectoryOptions drive;
  drive.n_images = images;
  drive.seed = 11;
  std::vector<Bytes> files;
  rendered::CameraConditions conditions;
  for (const auto& pose : rendered::trajectory(world, drive)) {
    conditions.noise_seed = files.size();
    cv::imencode(".jpg", world.render(pose, conditions).bgr, files.emplace_back(), {cv::IMWRITE_JPEG_QUALITY, 95});
  }
  return files;
}

struct Row {
  int vertices = 0;
  double stage_ms[server::kStages.size()] = {};
  double all_ms = 0;
};

int run(int small, int large) {
  cv::setNumThreads(1);
  keep_freed_memory();
  constexpr int kSample = 100;
  const int images = large + large / 4 + 2 * kSample;  // some will be ignored
  std::fprintf(stderr, "rendering %d images\n", images);
  const auto files = render_drive(images);

  test::TempStore store;
  server::VocabularyService vocabularies(store.store());
  vocabularies.set_default(MAPWELD_SOURCE_DIR "/vocabularies/indoor-50k.mwv");
  server::MapCache cache(store.store(), std::size_t{1} << 30);
  server::WorkerPool workers(1);
  server::LocalDecoder decoder;
  server::MapOpener opener(store.store(), cache);
  server::MapService maps(store.store(), opener, vocabularies, [](std::int64_t) {});
  contract::CreateMap request;
  request.name = "drive";
  maps.create(request);

  std::vector<Row> rows;
  std::size_t next = 0;
  int vertices = 0;
  const auto upload = [&](server::ImageService& service) {
    const auto outcome = service.upload("drive", {std::to_string(next), files.at(next), {}}, {});
    ++next;
    if (outcome.created) ++vertices;
    return outcome.upload.took_ms;
  };
  for (const int size : {small, large}) {
    server::Metrics unmeasured;
    server::ImageService filling(store.store(), cache, vocabularies, workers, decoder, unmeasured);
    while (vertices < size) upload(filling);
    server::Metrics metrics;
    server::ImageService measured(store.store(), cache, vocabularies, workers, decoder, metrics);
    std::vector<double> all_ms;
    for (int i = 0; i < kSample; ++i) all_ms.push_back(upload(measured));
    std::nth_element(all_ms.begin(), all_ms.begin() + kSample / 2, all_ms.end());
    Row row;
    row.vertices = size;
    row.all_ms = all_ms[kSample / 2];
    for (std::size_t s = 0; s < server::kStages.size(); ++s) {
      row.stage_ms[s] = metrics.stage(server::kStages[s]).summary().median_s * 1e3;
    }
    rows.push_back(row);
  }

  std::printf("| vertices |");
  for (const auto stage : server::kStages) std::printf(" %s |", std::string(to_string(stage)).c_str());
  std::printf(" all |\n|---|");
  for (std::size_t s = 0; s <= server::kStages.size(); ++s) std::printf("---|");
  std::printf("\n");
  for (const Row& row : rows) {
    std::printf("| %d |", row.vertices);
    for (const double ms : row.stage_ms) std::printf(" %.2f |", ms);
    std::printf(" %.1f |\n", row.all_ms);
  }
  return 0;
}

}  // namespace
}  // namespace mapweld

int main(int argc, char** argv) {
  const int small = argc > 2 ? std::atoi(argv[1]) : 500;
  const int large = argc > 2 ? std::atoi(argv[2]) : 1356;
  return mapweld::run(small, large);
}
