#include "tests/support/trajectory.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "tests/support/rendering/floor_plan.h"
#include "tests/support/rendering/repeatable.h"

namespace mapweld::rendered {
namespace {

// A corner of the route; at some the robot looks all round before it drives on.
struct Waypoint {
  double x = 0;
  double y = 0;
  bool look_round = false;
};

double middle_y(const Area& area) { return (area.y0 + area.y1) / 2; }
double middle_x(const Area& area) { return (area.x0 + area.x1) / 2; }

// Along one corridor, with visits to the open rooms on the way.
void drive_corridor(const FloorPlan& plan, int corridor, bool eastwards, double enters_room, std::uint64_t seed,
                    std::vector<Waypoint>& route) {
  std::vector<const Room*> rooms;
  for (const Room& room : plan.rooms) {
    if (room.corridor == corridor && room.open) rooms.push_back(&room);
  }
  std::sort(rooms.begin(), rooms.end(), [&](const Room* a, const Room* b) {
    return eastwards ? a->door_x_m < b->door_x_m : a->door_x_m > b->door_x_m;
  });
  const double y = middle_y(plan.corridors[static_cast<std::size_t>(corridor)]);
  for (const Room* room : rooms) {
    Random random(hash_of(seed, room->seed));
    if (!random.chance(enters_room)) continue;
    route.push_back({room->door_x_m, y, false});
    route.push_back({room->door_x_m, room->lookout().y0, random.chance(0.5)});
    route.push_back({room->door_x_m, y, false});
  }
}

// One lap, closed.
std::vector<Waypoint> lap_route(const FloorPlan& plan, const TrajectoryOptions& options) {
  std::vector<Waypoint> route;
  const int corridors = static_cast<int>(plan.corridors.size());
  if (corridors == 1) {
    const Area& area = plan.corridors.front();
    route.push_back({area.x0 + 1.2, middle_y(area), false});
    drive_corridor(plan, 0, true, options.enters_room, options.seed, route);
    route.push_back({area.x1 - 1.2, middle_y(area), false});
    return route;
  }
  const double west = middle_x(plan.cross_corridors[0]);
  const double east = middle_x(plan.cross_corridors[1]);
  for (int k = 0; k < corridors; ++k) {
    const bool eastwards = k % 2 == 0;
    const double y = middle_y(plan.corridors[static_cast<std::size_t>(k)]);
    route.push_back({eastwards ? west : east, y, false});
    drive_corridor(plan, k, eastwards, options.enters_room, options.seed, route);
    route.push_back({eastwards ? east : west, y, false});
  }
  // An odd number of corridors ends in the east: home along the last one.
  if (corridors % 2 == 1) route.push_back({west, middle_y(plan.corridors.back()), false});
  return route;
}

// Poses along the closed route: one every step, one every part of a turn.
class Driver {
 public:
  Driver(const TrajectoryOptions& options) : options_(options) {}

  std::vector<Pose> lap(std::vector<Waypoint> route) {
    if (options_.reversed) std::reverse(route.begin(), route.end());
    std::vector<Pose> poses;
    double heading = direction(route.back(), route.front());
    for (std::size_t i = 0; i < route.size(); ++i) {
      const Waypoint& here = route[i];
      const Waypoint& next = route[(i + 1) % route.size()];
      const double length = std::hypot(next.x - here.x, next.y - here.y);
      if (length < 1e-9) continue;
      const double towards = direction(here, next);
      double turn = signed_deg(towards - heading);
      if (here.look_round) turn += turn < 0 ? 360 : -360;
      const int turns = static_cast<int>(std::abs(turn) / options_.turn_deg + 0.5);
      for (int k = 1; k < turns; ++k) poses.push_back(at(here.x, here.y, heading + turn * k / turns));
      heading = towards;
      const int steps = std::max(1, static_cast<int>(length / options_.step_m + 0.5));
      for (int k = 0; k < steps; ++k) {
        const double t = static_cast<double>(k) / steps;
        poses.push_back(at(here.x + (next.x - here.x) * t, here.y + (next.y - here.y) * t, heading));
      }
    }
    return poses;
  }

 private:
  static double direction(const Waypoint& from, const Waypoint& to) {
    // Routes run along the axes.
    if (std::abs(to.x - from.x) > std::abs(to.y - from.y)) return to.x > from.x ? 0 : 180;
    return to.y > from.y ? 90 : 270;
  }
  Pose at(double x, double y, double heading) const {
    Pose pose;
    pose.x_m = x;
    pose.y_m = y;
    pose.heading_deg = wrap_deg(heading);
    pose.storey = options_.storey;
    return pose;
  }

  TrajectoryOptions options_;
};

void check(const TrajectoryOptions& options) {
  if (options.n_images < 0 || !(options.step_m >= 0.02) || !(options.turn_deg >= 1) ||
      !(options.turn_back_after >= 0)) {
    throw std::invalid_argument("a trajectory needs steps and turns of some size");
  }
}

}  // namespace

int lap_length(const RenderedWorld& world, const TrajectoryOptions& options) {
  check(options);
  return static_cast<int>(Driver(options).lap(lap_route(world.plan(), options)).size());
}

std::vector<Pose> trajectory(const RenderedWorld& world, const TrajectoryOptions& options) {
  check(options);
  const std::vector<Pose> lap = Driver(options).lap(lap_route(world.plan(), options));
  const auto length = static_cast<std::int64_t>(lap.size());
  std::vector<Pose> poses;
  poses.reserve(static_cast<std::size_t>(options.n_images));
  const int outward = static_cast<int>(options.n_images * std::min(1.0, options.turn_back_after));
  const int turns = std::max(1, static_cast<int>(180 / options.turn_deg + 0.5));
  for (int i = 0; i < options.n_images; ++i) {
    // Out, half a turn on the spot, and back along the same way looking the other way.
    std::int64_t index = i;
    double extra_turn = 0;
    if (i >= outward) {
      const int after = i - outward;
      index = after < turns ? outward - 1 : outward - 1 - (after - turns + 1);
      extra_turn = after < turns ? 180.0 * (after + 1) / turns : 180;
    }
    Pose pose = lap[static_cast<std::size_t>((((options.start + index) % length) + length) % length)];
    const double heading = pose.heading_deg;
    Random random(hash_of(options.seed, 71, i));
    const double sway = options.sway_m * slow_noise(hash_of(options.seed, 72), i / 9.0);
    pose.x_m += -sin_deg(heading) * sway;
    pose.y_m += cos_deg(heading) * sway;
    pose.heading_deg = wrap_deg(heading + extra_turn + options.heading_jitter_deg * random.gaussian());
    pose.pitch_deg = 0.4 * random.gaussian();
    poses.push_back(pose);
  }
  return poses;
}

TwoRobots two_robots(const RenderedWorld& world, int n_images_a, int n_images_b, std::uint64_t seed, double overlap) {
  TwoRobots robots;
  robots.a.n_images = n_images_a;
  robots.a.seed = hash_of(seed, 81);
  robots.b.n_images = n_images_b;
  robots.b.seed = hash_of(seed, 82);
  robots.b.turn_back_after = 0.7;
  const double outward = n_images_b * robots.b.turn_back_after;
  const int meet = std::max(0, static_cast<int>(n_images_a - outward * std::clamp(overlap, 0.0, 1.0)));
  // The robots enter different rooms, so that their laps differ: b starts where a is at that image.
  const std::vector<Pose> lap_a = Driver(robots.a).lap(lap_route(world.plan(), robots.a));
  const std::vector<Pose> lap_b = Driver(robots.b).lap(lap_route(world.plan(), robots.b));
  const Pose& there = lap_a[static_cast<std::size_t>(meet) % lap_a.size()];
  const auto apart = [&](const Pose& pose) {
    return std::hypot(pose.x_m - there.x_m, pose.y_m - there.y_m) +
           std::abs(signed_deg(pose.heading_deg - there.heading_deg)) / 90;
  };
  const auto nearest =
      std::min_element(lap_b.begin(), lap_b.end(), [&](const Pose& p, const Pose& q) { return apart(p) < apart(q); });
  robots.b.start = static_cast<int>(nearest - lap_b.begin());
  return robots;
}

std::vector<Pose> query_poses(const RenderedWorld& world, const std::vector<Pose>& driven, int n_queries,
                              std::uint64_t seed) {
  if (driven.empty()) throw std::invalid_argument("queries need drives to be near to");
  Random random(hash_of(seed, 91));
  std::vector<Pose> poses;
  for (int attempt = 0; static_cast<int>(poses.size()) < n_queries; ++attempt) {
    if (attempt > 1000 + 200 * n_queries) throw std::runtime_error("no free space for queries");
    Pose pose = random.pick(driven);
    const double angle = random.uniform(0, 360);
    const double distance = random.uniform(0.15, 0.6);
    pose.x_m += distance * cos_deg(angle);
    pose.y_m += distance * sin_deg(angle);
    pose.heading_deg = wrap_deg(pose.heading_deg + random.uniform(-14, 14));
    pose.pitch_deg = random.uniform(-1.5, 1.5);
    pose.height_m += random.uniform(-0.06, 0.06);
    if (world.is_free(pose, 0.25)) poses.push_back(pose);
  }
  return poses;
}

}  // namespace mapweld::rendered
