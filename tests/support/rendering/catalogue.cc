#include "tests/support/rendering/catalogue.h"

namespace mapweld::rendered {

const Texture* Catalogue::texture(Design design, std::uint64_t index) {
  std::unique_ptr<Texture>& slot = textures_[{design, index}];
  if (!slot) {
    Random random(hash_of(seed_, static_cast<int>(design), index));
    if (design <= Design::kPaint) {
      slot = std::make_unique<Texture>(paint_material(design, random), Texture::Edge::kTiled);
    } else {
      const cv::Mat picture = design == Design::kPoster    ? paint_poster(random)
                              : design == Design::kPicture ? paint_picture(random)
                              : design <= Design::kWindow  ? paint_wall_thing(design, index, random)
                                                           : paint_furniture(design, random);
      slot = std::make_unique<Texture>(picture, Texture::Edge::kClamped);
    }
  }
  return slot.get();
}

}  // namespace mapweld::rendered
