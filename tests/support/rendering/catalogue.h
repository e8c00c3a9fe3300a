// The catalogue from which buildings are furnished: designs of materials, posters and things, painted when first used.
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <tuple>

#include "tests/support/rendering/paint.h"
#include "tests/support/rendering/texture.h"
#include "tests/support/rendering/wear.h"

namespace mapweld::rendered {

enum class Design : std::uint8_t {
  // materials, tiled
  kWall,      // 4 m x a storey, skirting included
  kFloor,     // 2 m x 2 m
  kCeiling,   // 2.4 m x 2.4 m
  kLaminate,  // 1 m x 1 m, for furniture
  kFabric,    // 1 m x 1 m
  kMetal,     // 1 m x 1 m
  kConcrete,  // 1 m x 1 m
  kCables,    // 1 m x 0.16 m, a tray of cables under a ceiling
  kPaint,     // 1 m x 1 m, plain lacquer for frames and legs
  // flat things on walls
  kPoster,        // 0.59 m x 0.84 m
  kPicture,       // 0.90 m x 0.60 m
  kNoticeBoard,   // 1.5 m x 1.0 m
  kWhiteboard,    // 1.6 m x 1.0 m
  kDoor,          // 0.98 m x 2.08 m
  kSheet,         // 0.21 m x 0.30 m
  kDoorPlate,     // 0.22 m x 0.16 m; the index is the room's number
  kSign,          // 0.40 m x 0.20 m
  kExitSign,      // 0.44 m x 0.20 m
  kClock,         // 0.32 m x 0.32 m, cut out
  kExtinguisher,  // 0.20 m x 0.55 m, cut out
  kHoseBox,       // 0.60 m x 0.75 m
  kSwitch,        // 0.09 m x 0.16 m
  kSocket,        // 0.22 m x 0.09 m
  kGrille,        // 0.45 m x 0.25 m, of the ventilation
  kWindow,        // 1.5 m x 1.3 m: the view outside
  // fronts of furniture
  kBookshelf,   // 0.9 m x 2.0 m
  kStoreShelf,  // 1.1 m x 2.0 m
  kCabinet,     // 0.8 m x 1.3 m
  kDrawers,     // 0.42 m x 0.6 m
  kVending,     // 0.9 m x 1.85 m
  kFridge,      // 0.62 m x 1.8 m
  kKitchen,     // 1.8 m x 0.88 m
  kCopier,      // 0.65 m x 1.0 m
  kRack,        // 0.62 m x 1.9 m: servers and instruments
  kRadiator,    // 1.1 m x 0.55 m
  // things on desks and floors
  kScreen,     // 0.52 m x 0.32 m
  kKeyboard,   // 0.45 m x 0.16 m
  kPaper,      // 0.30 m x 0.21 m
  kLeaves,     // 0.9 m x 1.1 m, cut out
  kCarton,     // 0.45 m x 0.35 m
  kRug,        // 2.0 m x 1.4 m
  kLampPanel,  // 1.2 m x 0.3 m
  kVent,       // 0.6 m x 0.6 m
  // wear
  kMark,  // 0.4 m x 0.4 m, cut out
};

// Not for several threads while textures are being painted.
class Catalogue {
 public:
  explicit Catalogue(std::uint64_t seed) : seed_(seed) {}

  // The design number `index` of a kind, or a worn copy of it. Valid as long as the catalogue.
  const Texture* texture(Design design, std::uint64_t index, const WornCopy& copy = {});

 private:
  std::uint64_t seed_;
  std::map<std::tuple<Design, std::uint64_t, std::uint64_t>, std::unique_ptr<Texture>> textures_;
};

// Painters, by what they paint (paint_*.cc). All draw from what is random in their arguments alone.
cv::Mat paint_material(Design design, Random& random);
cv::Mat paint_poster(Random& random);
cv::Mat paint_picture(Random& random);
// `notices`, which may be the same: decide what is taped to it.
cv::Mat paint_wall_thing(Design design, std::uint64_t index, Random& random, Random& notices);
cv::Mat paint_furniture(Design design, Random& random);  // and what stands and lies about
cv::Mat paint_machine(Design design, Random& random);

}  // namespace mapweld::rendered
