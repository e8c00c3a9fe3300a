// Pairs of images of rendered drives that the verifier accepts, with the truth about how their cameras stand.
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "core/types.h"
#include "tests/support/rendered_world.h"
#include "tests/support/true_pose.h"

namespace mapweld::rendered {

struct PosedPair {
  std::shared_ptr<const AppearanceVector> a;
  std::shared_ptr<const AppearanceVector> b;
  Verification verification;
  TruePose truth;
  double shared = 0;  // co-visibility; about 0 where the verifier was taken in
};

// Every accepted pair of two robots' images of one building, of one robot among themselves too.
struct PosedPairsOptions {
  int n_images_a = 60;
  int n_images_b = 40;
  std::uint64_t seed = 1;
  CameraModel camera = {};
  int threads = 1;
};
std::vector<PosedPair> posed_pairs(const PosedPairsOptions& options);

}  // namespace mapweld::rendered
