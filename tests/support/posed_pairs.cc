#include "tests/support/posed_pairs.h"

#include <cmath>
#include <cstddef>
#include <optional>

#include "core/geometry/epipolar_verifier.h"
#include "tests/support/rendered_merge.h"
#include "tests/support/rendering/parallel.h"
#include "tests/support/sample_maps.h"
#include "tests/support/shared_view.h"
#include "tests/support/trajectory.h"

namespace mapweld::rendered {

std::vector<PosedPair> posed_pairs(const PosedPairsOptions& options) {
  WorldOptions how = world_for_maps(options.n_images_a, options.n_images_b, options.seed);
  how.camera = options.camera;
  const RenderedWorld world(how);
  const TwoRobots robots = two_robots(world, options.n_images_a, options.n_images_b, options.seed);
  std::vector<Pose> poses = trajectory(world, robots.a);
  const std::vector<Pose> poses_b = trajectory(world, robots.b);
  const auto vocabulary = shipped_vocabulary();
  std::vector<AppearanceVector> seen = see(world, poses, conditions_of_a(), options.seed, *vocabulary, options.threads);
  for (AppearanceVector& image :
       see(world, poses_b, conditions_of_b(), options.seed + 1, *vocabulary, options.threads)) {
    seen.push_back(std::move(image));
  }
  poses.insert(poses.end(), poses_b.begin(), poses_b.end());
  const std::vector<ViewRecord> views = view_records(world, poses, options.threads);

  const auto verifier = make_verifier();
  std::vector<std::shared_ptr<const AppearanceVector>> images;
  std::vector<std::shared_ptr<const PreparedImage>> prepared;
  for (AppearanceVector& image : seen) {
    images.push_back(std::make_shared<const AppearanceVector>(std::move(image)));
    prepared.push_back(verifier->prepare(images.back()));
  }
  std::vector<std::vector<PosedPair>> of_image(images.size());
  for_each_index(static_cast<int>(images.size()), options.threads, [&](int index) {
    const auto i = static_cast<std::size_t>(index);
    for (std::size_t j = 0; j < i; ++j) {
      Verification verification = verifier->verify_prepared(*prepared[i], *prepared[j]);
      if (!verification.accepted) continue;
      of_image[i].push_back({.a = images[i],
                             .b = images[j],
                             .verification = std::move(verification),
                             .truth = true_pose(poses[i], poses[j]),
                             .shared = shared_view(views[i], views[j])});
    }
  });
  std::vector<PosedPair> pairs;
  for (std::vector<PosedPair>& some : of_image) {
    for (PosedPair& pair : some) pairs.push_back(std::move(pair));
  }
  return pairs;
}

}  // namespace mapweld::rendered
