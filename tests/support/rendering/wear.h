// What years of use make of storeys that were built alike: each gets its own stains and scratches, notices, lamps and
// clutter. Where there is no wear, nothing here changes anything or draws a number.
#pragma once

#include <cstdint>

#include <opencv2/core/mat.hpp>

#include "tests/support/rendering/repeatable.h"

namespace mapweld::rendered {

class Builder;
enum class Design : std::uint8_t;
struct Scene;
struct Wall;

// A copy of a design that has aged on its own; 0: as new.
struct WornCopy {
  std::uint64_t number = 0;
  double amount = 0;  // how much, 0 to 1
};

// The wear of one storey. Its numbers are its own: those that furnish a storey stay what they are, so that storeys that
// look alike keep their plan and have the same pieces at the same places.
class Wear {
 public:
  Wear() = default;
  // `amount`: from 0, as new, to 1, as two real storeys of one design differ.
  Wear(double amount, std::uint64_t seed, int storey);

  bool is_none() const { return amount_ <= 0; }

  // Whether it came to this; the probability is that of full wear.
  bool happens(double probability);
  // By how much a thing has been moved, turned or grown: within +-most.
  double shift(double most);
  // What is found instead of number `one` of `n`: by this probability any of them.
  std::uint64_t other(std::uint64_t one, int n, double probability);
  // The name of a place to the deck: by this probability one that no other storey has.
  std::uint64_t other_place(std::uint64_t key, double probability);
  // Numbers for what is done anew.
  Random numbers() { return Random(random_.next()); }
  // Which copy of a design covers the next surface.
  WornCopy copy_of(Design design);
  // Of a lamp, as a share of a new one's; 0: it is off.
  double lamp_power();

  // Scuffs, holes, patches and remains of tape on a wall; spots on floor and ceiling.
  void mark_wall(Builder& builder, const Wall& wall);
  void mark_floor_and_ceiling(Builder& builder);
  // Makes the light on surfaces uneven, and other than on their likes. After light_scene().
  void shade(Scene& scene);

 private:
  double amount_ = 0;
  std::uint64_t own_ = 0;
  Random random_{0};
};

// Stains, scratches, another tint and another grain on a painted picture; one that tiles still does.
void wear_down(cv::Mat& canvas, bool tiles, double amount, Random& random);
// What a window shows, from higher up or further down, and from a little nearer.
cv::Mat seen_from_another_storey(const cv::Mat& view, double amount, Random& random);
// A mark on a wall or a floor, 0.4 m x 0.4 m, cut out.
cv::Mat paint_mark(Random& random);

}  // namespace mapweld::rendered
