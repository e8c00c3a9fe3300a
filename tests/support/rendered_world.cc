#include "tests/support/rendered_world.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>
#include <string>

#include "tests/support/rendering/camera_effects.h"
#include "tests/support/rendering/catalogue.h"
#include "tests/support/rendering/floor_plan.h"
#include "tests/support/rendering/rasterizer.h"
#include "tests/support/rendering/storey.h"

namespace mapweld::rendered {
namespace {

constexpr int kOversampling = 2;  // samples a pixel in each direction

// A camera whose pixel p lies at `offset + p * pitch` of the model's pixels.
PinholeCamera camera_at(const Pose& pose, const CameraModel& model, double pitch, double offset, int width,
                        int height) {
  const double ch = cos_deg(pose.heading_deg);
  const double sh = sin_deg(pose.heading_deg);
  const double cp = cos_deg(pose.pitch_deg);
  const double sp = sin_deg(pose.pitch_deg);
  PinholeCamera camera;
  camera.position = {pose.x_m, pose.y_m, pose.height_m};
  camera.forward = {ch * cp, sh * cp, sp};
  camera.right = {sh, -ch, 0};
  camera.down = {ch * sp, sh * sp, -cp};
  camera.focal_px = model.focal_px / pitch;
  camera.centre_x_px = ((model.width_px - 1) / 2.0 - offset) / pitch;
  camera.centre_y_px = ((model.height_px - 1) / 2.0 - offset) / pitch;
  camera.width_px = width;
  camera.height_px = height;
  return camera;
}

// The cell that holds a point, with doorways halved between their cells; -1 if there is none.
int cell_at(const Scene& scene, double x, double y, double wall_m) {
  for (const double margin : {0.0, -wall_m / 2 - 1e-6}) {
    for (std::size_t i = 0; i < scene.cells.size(); ++i) {
      if (scene.cells[i].area.contains(x, y, margin)) return static_cast<int>(i);
    }
  }
  return -1;
}

}  // namespace

struct RenderedWorld::Parts {
  WorldOptions options;
  FloorPlan plan;
  Catalogue catalogue;
  std::vector<Storey> storeys;
  std::vector<Poster> posters;

  explicit Parts(const WorldOptions& o) : options(o), catalogue(o.catalogue_seed) {}

  const Scene& scene(int storey) const {
    if (storey < 0 || storey >= static_cast<int>(storeys.size())) {
      throw std::out_of_range("the building has no storey " + std::to_string(storey));
    }
    return storeys[static_cast<std::size_t>(storey)].scene;
  }
  int cell_of(const Pose& pose) const {
    const int cell = cell_at(scene(pose.storey), pose.x_m, pose.y_m, plan.wall_m);
    if (cell < 0) throw std::out_of_range("a camera outside of the building");
    return cell;
  }
};

RenderedWorld::RenderedWorld(const WorldOptions& options) : parts_(std::make_unique<Parts>(options)) {
  const CameraModel& camera = options.camera;
  if (options.storeys < 1 || options.storeys > 100 || options.catalogue_posters < 1 || camera.width_px < 16 ||
      camera.width_px > 4096 || camera.height_px < 16 || camera.height_px > 4096 || !(camera.focal_px > 1)) {
    throw std::invalid_argument("a world needs a storey, a poster and a camera");
  }
  if (!(options.worn_copies >= 0) || !(options.worn_copies <= 1)) {
    throw std::invalid_argument("storeys are worn from 0 to 1");
  }
  parts_->plan = make_floor_plan({options.corridors, options.corridor_length_m, options.open_rooms,
                                  options.look_alike_corridors > 0, options.seed});
  Deck deck(hash_of(options.seed, 61), options.catalogue_posters, options.posters_in_two_places);
  for (int i = 0; i < options.storeys; ++i) {
    const StoreyOptions storey{options.seed, i, options.look_alike_corridors, options.look_alike_storeys,
                               options.worn_copies};
    parts_->storeys.push_back(build_storey(parts_->plan, storey, parts_->catalogue, deck));
    for (const PosterPlace& place : parts_->storeys.back().posters) {
      const double facing = place.facing.x > 0.5 ? 0 : place.facing.y > 0.5 ? 90 : place.facing.x < -0.5 ? 180 : 270;
      parts_->posters.push_back({place.design, i, place.position.x, place.position.y, facing});
    }
  }
}

RenderedWorld::~RenderedWorld() = default;
RenderedWorld::RenderedWorld(RenderedWorld&&) noexcept = default;
RenderedWorld& RenderedWorld::operator=(RenderedWorld&&) noexcept = default;

const WorldOptions& RenderedWorld::options() const { return parts_->options; }
const FloorPlan& RenderedWorld::plan() const { return parts_->plan; }
const std::vector<Poster>& RenderedWorld::posters() const { return parts_->posters; }

Frame RenderedWorld::render(const Pose& pose, const CameraConditions& conditions) const {
  const CameraModel& model = parts_->options.camera;
  const int cell = parts_->cell_of(pose);
  const int width = model.width_px * kOversampling;
  const PinholeCamera camera =
      camera_at(pose, model, 1.0 / kOversampling, -0.5 + 0.5 / kOversampling, width, model.height_px * kOversampling);
  thread_local Buffers buffers;
  rasterize(parts_->scene(pose.storey), cell, camera, {true, conditions.lamps, conditions.daylight}, buffers);

  Frame frame;
  frame.bgr = expose(buffers.colour, model.width_px, model.height_px, kOversampling, conditions);
  frame.depth_m.create(model.height_px, model.width_px, CV_32F);
  frame.surface.create(model.height_px, model.width_px, CV_32S);
  for (int y = 0; y < model.height_px; ++y) {
    for (int x = 0; x < model.width_px; ++x) {
      const std::size_t first = static_cast<std::size_t>(y * kOversampling) * static_cast<std::size_t>(width) +
                                static_cast<std::size_t>(x * kOversampling);
      const std::array<std::size_t, 4> samples{first, first + 1, first + static_cast<std::size_t>(width),
                                               first + static_cast<std::size_t>(width) + 1};
      // The surface seen by most samples; inverse depth is linear over it, so that the mean is that of the middle.
      std::uint32_t best = kNoSurface;
      int best_count = 0;
      float best_sum = 0;
      for (const std::size_t i : samples) {
        int count = 0;
        float sum = 0;
        for (const std::size_t j : samples) {
          if (buffers.surface[j] != buffers.surface[i]) continue;
          ++count;
          sum += buffers.inverse_depth[j];
        }
        if (count > best_count) {
          best = buffers.surface[i];
          best_count = count;
          best_sum = sum;
        }
      }
      frame.surface.at<int>(y, x) = best == kNoSurface ? -1 : static_cast<int>(best);
      frame.depth_m.at<float>(y, x) = best == kNoSurface ? 0.0F : static_cast<float>(best_count) / best_sum;
    }
  }
  return frame;
}

Frame RenderedWorld::render_geometry(const Pose& pose, int scale) const {
  const CameraModel& model = parts_->options.camera;
  if (scale < 1 || model.width_px % scale != 0 || model.height_px % scale != 0) {
    throw std::invalid_argument("the scale of a depth image divides the size of the image");
  }
  const int cell = parts_->cell_of(pose);
  const int width = model.width_px / scale;
  const int height = model.height_px / scale;
  const PinholeCamera camera = camera_at(pose, model, scale, (scale - 1) / 2.0, width, height);
  thread_local Buffers buffers;
  rasterize(parts_->scene(pose.storey), cell, camera, {false, 1, 1}, buffers);
  Frame frame;
  frame.depth_m.create(height, width, CV_32F);
  frame.surface.create(height, width, CV_32S);
  for (std::size_t i = 0; i < buffers.surface.size(); ++i) {
    const bool seen = buffers.surface[i] != kNoSurface;
    frame.surface.ptr<int>()[i] = seen ? static_cast<int>(buffers.surface[i]) : -1;
    frame.depth_m.ptr<float>()[i] = seen ? 1.0F / buffers.inverse_depth[i] : 0.0F;
  }
  return frame;
}

bool RenderedWorld::is_free(const Pose& pose, double margin_m) const {
  const Scene& scene = parts_->scene(pose.storey);
  const auto inside = [&](double x, double y) {
    const int index = cell_at(scene, x, y, 0);
    if (index >= 0) {
      const Cell& cell = scene.cells[static_cast<std::size_t>(index)];
      return std::none_of(cell.footprints.begin(), cell.footprints.end(),
                          [&](const Area& area) { return area.contains(x, y); });
    }
    return std::any_of(parts_->plan.rooms.begin(), parts_->plan.rooms.end(), [&](const Room& room) {
      const double door_y = room.north ? room.area.y0 : room.area.y1;
      return room.open && std::abs(x - room.door_x_m) < parts_->plan.door_width_m / 2 &&
             std::abs(y - door_y) <= parts_->plan.wall_m;
    });
  };
  for (const double dx : {-margin_m, 0.0, margin_m}) {
    for (const double dy : {-margin_m, 0.0, margin_m}) {
      if (!inside(pose.x_m + dx, pose.y_m + dy)) return false;
    }
  }
  return true;
}

}  // namespace mapweld::rendered
