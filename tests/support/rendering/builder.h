// Puts rectangles and boxes into a cell, in the coordinates of a wall.
#pragma once

#include "tests/support/rendering/catalogue.h"
#include "tests/support/rendering/scene.h"
#include "tests/support/rendering/wear.h"

namespace mapweld::rendered {

// A place at a wall: s to the right along the wall as seen by who faces it, t out of the wall, z up. `along` and `out`
// are unit vectors on the floor.
struct WallFrame {
  Vec3 origin;
  Vec3 along;
  Vec3 out;

  static WallFrame facing(const Vec3& origin, const Vec3& out) { return {origin, {-out.y, out.x, 0}, out}; }
  Vec3 at(double s, double t, double z) const { return origin + along * s + out * t + Vec3{0, 0, z}; }
  WallFrame moved(double s, double t) const { return {at(s, t, 0), along, out}; }
  // Turned about its origin, counter-clockwise seen from above.
  WallFrame turned(double angle_deg) const;
  // Looking back at the wall from distance t: s runs the other way.
  WallFrame opposite(double s, double t) const { return {at(s, t, 0), along * -1, out * -1}; }
};

struct Span {
  double from = 0;
  double to = 0;
  double length() const { return to - from; }
};

// What a face is covered with: a picture fitted to it, or a material tiled every `tile_m`.
struct Skin {
  const Texture* texture = nullptr;
  double tile_m = 0;  // 0: fitted
  Glow glow = Glow::kNone;
  double tile_down_m = 0;  // 0: as across, and the material begins anywhere
  double u_offset = 0;     // where the material begins, if tile_down_m is given
  double v_offset = 0;
};

struct BoxSkin {
  Skin front;
  Skin sides;
  Skin top;
  Skin back;
};
inline BoxSkin all_over(const Skin& skin) { return {skin, skin, skin, skin}; }

class Builder {
 public:
  Builder(Catalogue& catalogue, Cell& cell, Wear& wear) : catalogue_(catalogue), cell_(cell), wear_(wear) {}
  // Builds the same elsewhere.
  Builder(const Builder& other, Cell& cell) : Builder(other.catalogue_, cell, other.wear_) {}

  Skin fitted(Design design, std::uint64_t index, Glow glow = Glow::kNone) {
    return {catalogue_.texture(design, index, wear_.copy_of(design)), 0, glow, 0, 0, 0};
  }
  Skin tiled(Design design, std::uint64_t index, double tile_m = 1.0) {
    return {catalogue_.texture(design, index, wear_.copy_of(design)), tile_m, Glow::kNone, 0, 0, 0};
  }

  // A vertical rectangle parallel to the wall at distance t, seen from the room.
  void panel(const WallFrame& frame, const Span& s, double t, const Span& z, const Skin& skin);
  // A horizontal rectangle seen from above, or from below.
  void sheet(const WallFrame& frame, const Span& s, const Span& t, double z, const Skin& skin, bool from_above = true);
  // A box without its bottom; `bottom` adds it.
  void box(const WallFrame& frame, const Span& s, const Span& t, const Span& z, const BoxSkin& skin,
           bool bottom = false);
  // A cut-out picture that stands upright through the middle of (s, t), seen from both sides, turned by an angle.
  void cut_out(const WallFrame& frame, double s, double t, double width, const Span& z, double angle_deg,
               const Skin& skin);
  // No robot stands here.
  void block(const WallFrame& frame, const Span& s, const Span& t);

  Cell& cell() { return cell_; }
  Wear& wear() { return wear_; }

 private:
  void add(const Vec3& corner, const Vec3& across, const Vec3& down, double width, double height, const Skin& skin);

  Catalogue& catalogue_;
  Cell& cell_;
  Wear& wear_;
};

}  // namespace mapweld::rendered
