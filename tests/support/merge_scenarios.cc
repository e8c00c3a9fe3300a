#include "tests/support/merge_scenarios.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <stdexcept>

#include "tests/support/rendering/floor_plan.h"
#include "tests/support/rendering/repeatable.h"
#include "tests/support/sample_maps.h"
#include "tests/support/trajectory.h"

namespace mapweld::rendered {
namespace {

constexpr int kImagesA = 120;
constexpr int kImagesB = 80;

// The poses of a lap while it is nearest to one corridor: its rooms included, cross corridors for the half next to it.
std::vector<Pose> along_corridor(const RenderedWorld& world, const TrajectoryOptions& lap, int corridor) {
  const auto& corridors = world.plan().corridors;
  std::vector<Pose> poses;
  for (const Pose& pose : trajectory(world, lap)) {
    int nearest = 0;
    double least = 1e9;
    for (std::size_t k = 0; k < corridors.size(); ++k) {
      const double away = std::abs(pose.y_m - (corridors[k].y0 + corridors[k].y1) / 2);
      if (away < least) {
        least = away;
        nearest = static_cast<int>(k);
      }
    }
    if (nearest == corridor) poses.push_back(pose);
  }
  return poses;
}

TrajectoryOptions whole_lap(const RenderedWorld& world, std::uint64_t seed, int storey = 0, bool reversed = false) {
  TrajectoryOptions lap;
  lap.seed = seed;
  lap.storey = storey;
  lap.reversed = reversed;
  lap.enters_room = 0.3;
  lap.n_images = lap_length(world, lap);
  return lap;
}

// Both robots, in one world or in two.
struct Cast {
  std::optional<RenderedWorld> world;
  std::optional<RenderedWorld> other_world;  // of b, where it is another
  std::vector<Pose> a;
  std::vector<Pose> b;
  MapParameters parameters;

  MadeMerge merge(std::uint64_t seed, const Vocabulary& vocabulary, int threads) const {
    const Drive drive_a{&*world, a, conditions_of_a(), hash_of(seed, 1)};
    const Drive drive_b{other_world ? &*other_world : &*world, b, conditions_of_b(), hash_of(seed, 2)};
    return make_merge(drive_a, drive_b, vocabulary, threads, parameters);
  }
};

void overlap_on_one_floor(Cast& cast, std::uint64_t seed, int images_a = kImagesA, int images_b = kImagesB) {
  const TwoRobots robots = two_robots(*cast.world, images_a, images_b, seed);
  cast.a = trajectory(*cast.world, robots.a);
  cast.b = trajectory(*cast.world, robots.b);
}

WorldOptions two_corridors(std::uint64_t seed) {
  WorldOptions options;
  options.corridors = 2;
  options.corridor_length_m = 7;
  options.seed = seed;
  return options;
}

Cast make_cast(std::string_view name, std::uint64_t seed) {
  Cast cast;
  if (name == "ordinary" || name == "look-alike") {
    cast.world.emplace(world_for_maps(kImagesA, kImagesB, seed, name == "look-alike"));
    overlap_on_one_floor(cast, seed);
  } else if (name == "large" || name == "large-look-alike") {
    cast.world.emplace(world_for_maps(1356, 610, seed, name == "large-look-alike"));
    overlap_on_one_floor(cast, seed, 1356, 610);
  } else if (name == "corridors" || name == "corridors-part" || name == "corridors-apart") {
    // Robots drive through the first and the third in the same direction.
    WorldOptions options = two_corridors(seed);
    options.corridors = 3;
    options.look_alike_corridors = 0.9;
    cast.world.emplace(options);
    cast.a = trajectory(*cast.world, whole_lap(*cast.world, hash_of(seed, 81)));
    cast.b = trajectory(*cast.world, whole_lap(*cast.world, hash_of(seed, 82)));
    if (name == "corridors-apart") cast.a = along_corridor(*cast.world, whole_lap(*cast.world, hash_of(seed, 81)), 0);
    if (name != "corridors") cast.b = along_corridor(*cast.world, whole_lap(*cast.world, hash_of(seed, 82)), 2);
  } else if (name == "storeys" || name == "storeys-lift" || name == "storeys-apart" || name == "worn-storeys" ||
             name == "worn-storeys-apart") {
    WorldOptions options = two_corridors(seed);
    options.corridors = 1;
    options.corridor_length_m = 12;
    options.storeys = 2;
    options.look_alike_storeys = 0.9;
    options.worn_copies = name.starts_with("worn") ? 1 : 0;
    cast.world.emplace(options);
    cast.a = trajectory(*cast.world, whole_lap(*cast.world, hash_of(seed, 81)));
    if (!name.ends_with("storeys-apart")) {
      // Upstairs it begins at the other end of the corridor; out of a lift, at the place where it left the floor below.
      TrajectoryOptions lap = whole_lap(*cast.world, hash_of(seed, 83), 1);
      if (name != "storeys-lift") lap.start = lap.n_images / 2;
      const auto above = trajectory(*cast.world, lap);
      cast.a.insert(cast.a.end(), above.begin(), above.end());
    }
    cast.b = trajectory(*cast.world, whole_lap(*cast.world, hash_of(seed, 82), 1));
  } else if (name == "worn-look-alike") {
    // Storeys share nothing but their design: as good as two buildings.
    WorldOptions options = two_corridors(seed);
    options.storeys = 2;
    options.look_alike_storeys = 1;
    options.worn_copies = 1;
    cast.world.emplace(options);
    cast.a = trajectory(*cast.world, whole_lap(*cast.world, hash_of(seed, 81)));
    cast.b = trajectory(*cast.world, whole_lap(*cast.world, hash_of(seed, 82), 1));
  } else if (name == "filmed-room") {
    WorldOptions options = two_corridors(seed);
    options.corridors = 1;
    options.open_rooms = 1;
    cast.world.emplace(options);
    FilmOptions take;
    take.room = largest_open_room(*cast.world);
    take.seed = hash_of(seed, 81);
    cast.a = film(*cast.world, take);
    take.seed = hash_of(seed, 82);
    cast.b = film(*cast.world, take);
    cast.parameters.max_inliers = kUnlimitedInliers;
  } else if (name == "posters") {
    WorldOptions options = two_corridors(seed);
    options.posters_in_two_places = 8;
    cast.world.emplace(options);
    overlap_on_one_floor(cast, seed);
  } else if (name == "posters-apart") {
    WorldOptions options = two_corridors(seed);
    options.posters_in_two_places = 8;
    cast.world.emplace(options);
    cast.a = along_corridor(*cast.world, whole_lap(*cast.world, hash_of(seed, 81)), 0);
    cast.b = along_corridor(*cast.world, whole_lap(*cast.world, hash_of(seed, 82)), 1);
  } else if (name == "reversed") {
    cast.world.emplace(two_corridors(seed));
    cast.a = trajectory(*cast.world, whole_lap(*cast.world, hash_of(seed, 81)));
    cast.b = trajectory(*cast.world, whole_lap(*cast.world, hash_of(seed, 82), 0, true));
  } else if (name == "laps") {
    cast.world.emplace(two_corridors(seed));
    TrajectoryOptions twice = whole_lap(*cast.world, hash_of(seed, 81));
    twice.n_images *= 2;
    cast.a = trajectory(*cast.world, whole_lap(*cast.world, hash_of(seed, 82)));
    cast.b = trajectory(*cast.world, twice);
  } else if (name == "crossing") {
    // a drives along the southern corridor; b comes out of its end and drives along the northern one.
    cast.world.emplace(two_corridors(seed));
    const TrajectoryOptions lap_a = whole_lap(*cast.world, hash_of(seed, 81));
    cast.a = along_corridor(*cast.world, lap_a, 0);
    TrajectoryOptions lap_b = whole_lap(*cast.world, hash_of(seed, 82));
    const auto poses = trajectory(*cast.world, lap_b);
    const auto south = along_corridor(*cast.world, lap_b, 0);
    const std::size_t first = south.size() > 22 ? south.size() - 22 : 0;
    cast.b.assign(south.begin() + static_cast<std::ptrdiff_t>(first), south.end());
    const auto north = along_corridor(*cast.world, lap_b, 1);
    cast.b.insert(cast.b.end(), north.begin(), north.end());
  } else if (name == "strangers") {
    WorldOptions options = two_corridors(hash_of(seed, 5));
    options.catalogue_seed = seed;
    options.catalogue_posters = 60;
    cast.world.emplace(options);
    options.seed = hash_of(seed, 6);
    cast.other_world.emplace(options);
    cast.a = trajectory(*cast.world, whole_lap(*cast.world, hash_of(seed, 81)));
    cast.b = trajectory(*cast.other_world, whole_lap(*cast.other_world, hash_of(seed, 82)));
  } else {
    throw std::invalid_argument("no scenario " + std::string(name));
  }
  return cast;
}

}  // namespace

const std::vector<MergeScenario>& merge_scenarios() {
  static const std::vector<MergeScenario> all{
      {"large", "ordinary at the size of the paper's maps, 1,356 and 610 images"},
      {"large-look-alike", "look-alike at that size"},
      {"ordinary", "two robots on one floor, their drives overlap"},
      {"look-alike", "the same in parallel corridors of which nine places in ten are alike"},
      {"corridors", "three look-alike corridors, both robots drive through all"},
      {"corridors-part", "the same, the second robot drives through the third"},
      {"corridors-apart", "the same, each robot drives through one, and not the same one", false},
      {"storeys", "two look-alike storeys, the first robot sees both, the second one", false},
      {"storeys-lift", "the same, and it comes up where it left the floor below", false},
      {"storeys-apart", "the same, each robot sees another one", false},
      {"worn-storeys", "storeys, each with wear, notices, light and clutter of its own"},
      {"worn-storeys-apart", "storeys-apart, likewise"},
      {"worn-look-alike", "two buildings of one design, likewise, each robot sees one"},
      {"filmed-room", "one room filmed twice at video rate, at another hour; every image is kept"},
      {"posters", "eight posters hang in two places each, drives overlap"},
      {"posters-apart", "the same, each robot drives through another corridor"},
      {"reversed", "the second robot drives the other way round"},
      {"laps", "the second robot drives its lap twice"},
      {"crossing", "drives that share the end of a corridor"},
      {"strangers", "two buildings furnished from one small catalogue"},
  };
  return all;
}

MadeMerge make_scenario(std::string_view name, std::uint64_t seed, const Vocabulary& vocabulary, int threads) {
  return make_cast(name, seed).merge(seed, vocabulary, threads);
}

}  // namespace mapweld::rendered
