#include "core/geometry/matchable_image.h"

#include <utility>

#include "core/geometry/portable_math.h"

namespace mapweld {

MatchableImage::MatchableImage(std::shared_ptr<const AppearanceVector> image)
    : PreparedImage(std::move(image)), words_(words_of(this->image())) {}

MatchableImage::MatchableImage(const AppearanceVector& image)
    : MatchableImage(std::shared_ptr<const AppearanceVector>(std::shared_ptr<void>(), &image)) {}

const SignaturesByAngle& MatchableImage::signatures() const {
  std::call_once(has_signatures_, [this] { signatures_.emplace(image()); });
  return *signatures_;
}

const FeaturePlaces& MatchableImage::places() const {
  std::call_once(has_places_, [this] { places_.emplace(image()); });
  return *places_;
}

std::uint64_t MatchableImage::content() const {
  std::call_once(has_content_, [this] { content_ = content_hash(image()); });
  return content_;
}

}  // namespace mapweld
