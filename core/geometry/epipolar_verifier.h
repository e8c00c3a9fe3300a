// The verifier of mapping, localization and merging (paper, section III-A): word matches, one-to-one -> similarity
// vote -> fundamental matrix or homography by RANSAC -> spatial consistency -> inliers and significance.
#pragma once

#include <memory>
#include <string>

#include "core/geometry/pair_verifier.h"

namespace mapweld {

class EpipolarVerifier final : public PairVerifier {
 public:
  explicit EpipolarVerifier(const VerifierOptions& options = {}) : options_(options) {}

  Verification verify(const AppearanceVector& a, const AppearanceVector& b) const override;
  std::shared_ptr<const PreparedImage> prepare(std::shared_ptr<const AppearanceVector> image) const override;
  Verification verify_prepared(const PreparedImage& a, const PreparedImage& b) const override;
  std::string version() const override { return options_.signatures ? "epipolar-3" : "epipolar-3-words"; }
  const VerifierOptions& options() const override { return options_; }

 private:
  VerifierOptions options_;
};

// The verifier that every flow uses unless it asks for another.
std::shared_ptr<const PairVerifier> make_verifier(const VerifierOptions& options = {});

}  // namespace mapweld
