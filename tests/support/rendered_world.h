// A sample world: textured indoor storeys, rendered in software, with the truth about every image.
//
// Corridors, rooms, doors, posters and furniture with real perspective, occlusion and parallax; robots with cameras,
// lighting and noise of their own; look-alike corridors and storeys that tempt a false match. Everything follows from
// seeds by arithmetic that is the same on every machine: same options, same pixels. docs/rendered-world.md shows it.
//
//   RenderedWorld world(WorldOptions{.corridors = 2, .seed = 7});
//   for (const Pose& pose : trajectory(world, {.n_images = 100})) world.render(pose).bgr ...
//
// Coordinates in metres: x east, y north, z up from the floor. Headings in degrees, counter-clockwise from east.
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include <opencv2/core/mat.hpp>

namespace mapweld::rendered {

// Where a camera is and looks. Roll is zero.
struct Pose {
  double x_m = 0;
  double y_m = 0;
  double height_m = 1.15;  // of the camera above the floor
  double heading_deg = 0;
  double pitch_deg = 0;  // up
  int storey = 0;
  friend bool operator==(const Pose&, const Pose&) = default;
};

// A pinhole camera with square pixels and its axis through the middle of the image.
struct CameraModel {
  int width_px = 320;
  int height_px = 240;
  double focal_px = 228;  // 70 degrees across
};

// What the building is like.
struct WorldOptions {
  int corridors = 2;              // parallel, joined at both ends into loops if two or more
  double corridor_length_m = 18;  // rooms line both sides
  int storeys = 1;                // one above the other, on the same plan
  double open_rooms = 0.6;        // share of the rooms that can be entered

  // Same doors, paint and floors in all corridors, and, with this probability for each place on a wall, the same
  // posters and furniture at the same place. 0: every corridor has its own. 1: only door plates and rooms differ.
  double look_alike_corridors = 0;
  // Likewise for storeys, rooms included. Storeys always share plan and paint.
  double look_alike_storeys = 0;
  // Has every storey aged on its own? Other stains, notices, lamps and clutter, on the same plan with the same pieces
  // at the same places. 0: as new, so that what looks alike is the same to the pixel. 1: as two real storeys differ.
  double worn_copies = 0;
  int posters_in_two_places = 0;  // so many posters hang twice, in otherwise different places

  std::uint64_t seed = 1;
  // Buildings of one catalogue choose from the same posters, books and furniture.
  std::uint64_t catalogue_seed = 1;
  int catalogue_posters = 400;  // no poster hangs twice by chance until all have been used

  CameraModel camera = {};
};

// How a robot's camera sees the world: its hour of the day, its sensor.
struct CameraConditions {
  double lamps = 0.95;       // weight of the light of lamps
  double daylight = 0.5;     // weight of the light through windows
  double gain = 1.0;         // exposure
  double gamma = 1.0;        // > 1: darker middle tones
  double warmth = 0.0;       // -1: bluish .. 1: reddish
  double vignetting = 0.15;  // loss of light in the corners, 0 .. 1

  double noise_sigma = 1.7;      // grey levels
  double motion_blur_px = 0;     // across, full length, at most 8
  std::uint64_t noise_seed = 0;  // seeds the noise of this image
};

struct Frame {
  cv::Mat bgr;      // CV_8UC3
  cv::Mat depth_m;  // CV_32F, along the optical axis; 0 where nothing is seen
  cv::Mat surface;  // CV_32S, number of the surface seen, -1 for nothing; surfaces are flat
};

// A poster on a wall. Posters of one design look the same.
struct Poster {
  std::uint64_t design = 0;
  int storey = 0;
  double x_m = 0;
  double y_m = 0;
  double facing_deg = 0;
};

struct FloorPlan;
struct Scene;

// Immutable after construction: any number of threads may render at once.
class RenderedWorld {
 public:
  // Builds and furnishes the storeys and paints their textures: some tenths of a second for a small world.
  // Throws std::invalid_argument for options that make no building.
  explicit RenderedWorld(const WorldOptions& options);
  ~RenderedWorld();
  RenderedWorld(RenderedWorld&&) noexcept;
  RenderedWorld& operator=(RenderedWorld&&) noexcept;

  const WorldOptions& options() const;
  const FloorPlan& plan() const;  // the same for every storey
  const std::vector<Poster>& posters() const;

  // A pure function of its arguments. Throws std::out_of_range if the pose is in no room and no corridor.
  Frame render(const Pose& pose, const CameraConditions& conditions = {}) const;

  // Depth and surfaces alone, `scale` times smaller (a divisor of the image's size); each value is that of the middle
  // of its block of pixels. Much faster than render().
  Frame render_geometry(const Pose& pose, int scale = 1) const;

  // Whether a camera with this much room around it can be at the pose: in a room, corridor or open doorway, not in
  // furniture.
  bool is_free(const Pose& pose, double margin_m = 0.2) const;

 private:
  struct Parts;
  std::unique_ptr<Parts> parts_;
};

}  // namespace mapweld::rendered
