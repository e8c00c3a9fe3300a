#include "tests/support/rendering/catalogue.h"

namespace mapweld::rendered {
namespace {

bool is_machine(Design design) {
  switch (design) {
    case Design::kVending:
    case Design::kFridge:
    case Design::kCopier:
    case Design::kRack:
    case Design::kScreen:
    case Design::kKeyboard:
      return true;
    default:
      return false;
  }
}

cv::Mat paint(Design design, std::uint64_t index, Random& random, Random& notices) {
  if (design <= Design::kPaint) return paint_material(design, random);
  if (design == Design::kPoster) return paint_poster(random);
  if (design == Design::kPicture) return paint_picture(random);
  if (design <= Design::kWindow) return paint_wall_thing(design, index, random, notices);
  if (design == Design::kMark) return paint_mark(random);
  return is_machine(design) ? paint_machine(design, random) : paint_furniture(design, random);
}

}  // namespace

const Texture* Catalogue::texture(Design design, std::uint64_t index, const WornCopy& copy) {
  std::unique_ptr<Texture>& slot = textures_[{design, index, copy.number}];
  if (!slot) {
    Random random(hash_of(seed_, static_cast<int>(design), index));
    const bool tiles = design <= Design::kPaint;
    Random wear(hash_of(seed_, static_cast<int>(design), index, copy.number));
    const bool is_worn = copy.number != 0;
    cv::Mat picture = paint(design, index, random, is_worn ? wear : random);
    if (is_worn) {
      if (design == Design::kWindow) picture = seen_from_another_storey(picture, copy.amount, wear);
      wear_down(picture, tiles, copy.amount, wear);
    }
    slot = std::make_unique<Texture>(picture, tiles ? Texture::Edge::kTiled : Texture::Edge::kClamped);
  }
  return slot.get();
}

}  // namespace mapweld::rendered
