// Where the robots of a rendered world drive.
#pragma once

#include <cstdint>
#include <vector>

#include "tests/support/rendered_world.h"

namespace mapweld::rendered {

// A robot laps its storey: along every corridor, into rooms whose doors are open, where it turns round, and back
// through the cross corridors (or along the only corridor). It takes an image every `step_m` and, turning on the spot,
// every `turn_deg`.
struct TrajectoryOptions {
  int n_images = 100;
  std::uint64_t seed = 1;  // sways, jitters, and which rooms are entered
  int storey = 0;
  int start = 0;               // where on its lap it starts, in images
  bool reversed = false;       // laps the other way round
  double turn_back_after = 1;  // this share of the images done, it turns round and drives back
  double step_m = 0.4;
  double turn_deg = 18;
  double sway_m = 0.12;  // sideways, slowly changing
  double heading_jitter_deg = 1.5;
  double enters_room = 0.85;  // probability
};

// Exactly n_images poses, in order. Laps on and on if one is not enough.
std::vector<Pose> trajectory(const RenderedWorld& world, const TrajectoryOptions& options);

// Number of images of one lap; depends on the seed through the rooms that are entered.
int lap_length(const RenderedWorld& world, const TrajectoryOptions& options);

// The drives of two robots through one storey: `a` laps from the start; `b` drives where a share `overlap` of its
// outward images lies on a's drive, then turns and comes back the other way.
struct TwoRobots {
  TrajectoryOptions a;
  TrajectoryOptions b;
};
TwoRobots two_robots(const RenderedWorld& world, int n_images_a, int n_images_b, std::uint64_t seed,
                     double overlap = 0.75);

// A camera that is carried about in one room and films: it walks from one free place to the next, looks about as it
// goes, and turns all round more than once. Successive images are a few centimetres and degrees apart, as at video
// rate.
struct FilmOptions {
  int n_images = 90;
  std::uint64_t seed = 1;
  int storey = 0;
  std::size_t room = 0;  // of the plan's, an open one
  double step_m = 0.05;
  double turn_deg = 6;  // at most
};

// Exactly n_images poses, in order, all in free space. Throws std::invalid_argument for a closed room.
std::vector<Pose> film(const RenderedWorld& world, const FilmOptions& options);

// The open room with the largest floor. Throws std::invalid_argument if all are closed.
std::size_t largest_open_room(const RenderedWorld& world);

// Poses off the trajectories but near them: some decimetres aside and some degrees turned, in free space.
std::vector<Pose> query_poses(const RenderedWorld& world, const std::vector<Pose>& driven, int n_queries,
                              std::uint64_t seed);

}  // namespace mapweld::rendered
