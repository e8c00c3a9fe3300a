#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "tests/support/rendering/floor_plan.h"
#include "tests/support/rendering/repeatable.h"
#include "tests/support/trajectory.h"

namespace mapweld::rendered {
namespace {

constexpr double kMargin_m = 0.2;

// Walks through the free space of one room.
class Walker {
 public:
  Walker(const RenderedWorld& world, const Room& room, const FilmOptions& options)
      : world_(world), room_(room), options_(options), random_(hash_of(options.seed, 95)) {
    here_.x_m = room.lookout().x0;
    here_.y_m = room.lookout().y0;
    here_.storey = options.storey;
    there_ = here_;
  }

  Pose step() {
    double left = std::hypot(there_.x_m - here_.x_m, there_.y_m - here_.y_m);
    if (left < options_.step_m) {
      choose_goal();
      left = std::hypot(there_.x_m - here_.x_m, there_.y_m - here_.y_m);
    }
    if (left >= options_.step_m) {
      here_.x_m += (there_.x_m - here_.x_m) / left * options_.step_m;
      here_.y_m += (there_.y_m - here_.y_m) / left * options_.step_m;
    }
    return here_;
  }

 private:
  // A place that a straight way leads to; where none is found, it stays.
  void choose_goal() {
    for (int attempt = 0; attempt < 60; ++attempt) {
      Pose goal = here_;
      goal.x_m = random_.uniform(room_.area.x0, room_.area.x1);
      goal.y_m = random_.uniform(room_.area.y0, room_.area.y1);
      if (!is_free_way(goal)) continue;
      there_ = goal;
      return;
    }
  }
  bool is_free_way(const Pose& goal) const {
    constexpr int kParts = 20;
    for (int i = 1; i <= kParts; ++i) {
      Pose pose = here_;
      pose.x_m += (goal.x_m - here_.x_m) * i / kParts;
      pose.y_m += (goal.y_m - here_.y_m) * i / kParts;
      if (!room_.area.contains(pose.x_m, pose.y_m, kMargin_m) || !world_.is_free(pose, kMargin_m)) return false;
    }
    return true;
  }

  const RenderedWorld& world_;
  const Room& room_;
  const FilmOptions& options_;
  Random random_;
  Pose here_;
  Pose there_;
};

}  // namespace

std::vector<Pose> film(const RenderedWorld& world, const FilmOptions& options) {
  const auto& rooms = world.plan().rooms;
  if (options.room >= rooms.size() || !rooms[options.room].open) throw std::invalid_argument("that room is closed");
  Walker walker(world, rooms[options.room], options);
  const auto slow = [&](int what, double t) { return slow_noise(hash_of(options.seed, 96, what), t); };
  std::vector<Pose> poses;
  poses.reserve(static_cast<std::size_t>(options.n_images));
  double heading = Random(hash_of(options.seed, 97)).uniform(0, 360);
  for (int i = 0; i < options.n_images; ++i) {
    Pose pose = walker.step();
    // Round and round in the mean, with halts and ways back.
    heading = wrap_deg(heading + options.turn_deg * std::clamp(0.6 + 0.9 * slow(1, i / 12.0), -1.0, 1.0));
    pose.heading_deg = heading;
    pose.pitch_deg = 6 * slow(2, i / 10.0) - 2;
    pose.height_m = 1.45 + 0.06 * slow(3, i / 6.0);
    poses.push_back(pose);
  }
  return poses;
}

std::size_t largest_open_room(const RenderedWorld& world) {
  const auto& rooms = world.plan().rooms;
  const auto floor = [](const Room& room) { return room.open ? room.area.width() * room.area.height() : 0; };
  const auto largest =
      std::ranges::max_element(rooms, [&](const Room& a, const Room& b) { return floor(a) < floor(b); });
  if (largest == rooms.end() || !largest->open) throw std::invalid_argument("every room is closed");
  return static_cast<std::size_t>(largest - rooms.begin());
}

}  // namespace mapweld::rendered
