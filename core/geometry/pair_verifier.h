// Does a pair of images see the same thing? The verifier that every flow uses: mapping, localization, merging.
#pragma once

#include <memory>
#include <string>
#include <utility>

#include "core/types.h"

namespace mapweld {

// Seven matches determine a fundamental matrix; the eighth is the first that could contradict it.
inline constexpr int kFewestInliers = 8;

// Defaults measured, see docs/verification.md.
struct VerifierOptions {
  int min_inliers = 10;             // accept only with at least so many consistent matches (below 8: 8)
  double max_false_alarms = 1e-10;  // and only when chance would give them at most so often (a-contrario)
  bool signatures = true;  // match by signatures where both images have them; false: by words alone (the paper)
};

// The same verdict seen from the other image: what verify(b, a) gives when `v` is verify(a, b) (a homography: up to
// rounding).
Verification mirrored(Verification v);

// An image that is put to a verifier in many pairs: what is the same in all of them is worked out once, by `prepare`.
// Any number of threads may use it.
class PreparedImage {
 public:
  explicit PreparedImage(std::shared_ptr<const AppearanceVector> image) : image_(std::move(image)) {}
  virtual ~PreparedImage() = default;
  PreparedImage(const PreparedImage&) = delete;
  PreparedImage& operator=(const PreparedImage&) = delete;

  const AppearanceVector& image() const { return *image_; }

 private:
  std::shared_ptr<const AppearanceVector> image_;
};

// A pure function of two images. Implementations are immutable and thread-safe.
//
// Symmetric: verify(a, b) and verify(b, a) give the same verdict, with geometry transposed and matches swapped, because
// the pair is brought into a canonical order by content first and every random draw is seeded from content. Thus a
// verdict does not depend on ids, on which map an image is in, or on what was verified before.
class PairVerifier {
 public:
  virtual ~PairVerifier() = default;
  virtual Verification verify(const AppearanceVector& a, const AppearanceVector& b) const = 0;
  // The same verdict on images that this verifier prepared, sooner. A verifier that has nothing to prepare need not
  // override them.
  virtual std::shared_ptr<const PreparedImage> prepare(std::shared_ptr<const AppearanceVector> image) const {
    return std::make_shared<PreparedImage>(std::move(image));
  }
  virtual Verification verify_prepared(const PreparedImage& a, const PreparedImage& b) const {
    return verify(a.image(), b.image());
  }
  // Stored with every edge, so that verdicts of different verifiers are never mixed up, for example "epipolar-1".
  virtual std::string version() const = 0;
  virtual const VerifierOptions& options() const = 0;
};

}  // namespace mapweld
