// An image as EpipolarVerifier compares it with others.
#pragma once

#include <cstdint>
#include <memory>
#include <mutex>
#include <optional>

#include "core/geometry/pair_verifier.h"
#include "core/geometry/signature_matches.h"
#include "core/geometry/view_overlap.h"
#include "core/geometry/word_matches.h"

namespace mapweld {

// Its words at once; what most pairs come to an end without, when it is asked for first. Some 30 kilobytes for 500
// features.
class MatchableImage final : public PreparedImage {
 public:
  explicit MatchableImage(std::shared_ptr<const AppearanceVector> image);
  // Of an image that outlives this.
  explicit MatchableImage(const AppearanceVector& image);

  const ImageWords& words() const { return words_; }
  const SignaturesByAngle& signatures() const;
  const FeaturePlaces& places() const;
  std::uint64_t content() const;  // content_hash

 private:
  ImageWords words_;
  mutable std::once_flag has_signatures_, has_places_, has_content_;
  mutable std::optional<SignaturesByAngle> signatures_;
  mutable std::optional<FeaturePlaces> places_;
  mutable std::uint64_t content_ = 0;
};

}  // namespace mapweld
