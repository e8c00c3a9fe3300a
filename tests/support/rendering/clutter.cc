#include "tests/support/rendering/clutter.h"

#include "tests/support/rendering/repeatable.h"

namespace mapweld::rendered {
namespace {

// Makes what does not stay as it was put: `make` takes a builder and numbers. By this probability of wear it is another
// time's, or gone; what comes after it stays as it is.
template <typename Make>
void clutter(Builder& b, Random& random, double probability, const Make& make) {
  if (!b.wear().happens(probability)) {
    make(b, random);
    return;
  }
  Cell nowhere;
  Builder unseen(b, nowhere);
  make(unseen, random);
  if (b.wear().happens(0.3)) return;
  Random other = b.wear().numbers();
  make(b, other);
}

void thing_on_top(Builder& b, const WallFrame& f, const Span& s, const Span& t, double z, int number, Random& random) {
  const double x = random.uniform(s.from, s.to - 0.32);
  const double y = random.uniform(t.from, t.to - 0.24);
  switch (random.below(4)) {
    case 0: {  // a mug or a pot
      const BoxSkin skin = all_over(b.tiled(Design::kPaint, static_cast<std::uint64_t>(random.below(12)), 0.5));
      b.box(f, {x, x + 0.08}, {y, y + 0.08}, {z, z + 0.1}, skin);
      break;
    }
    case 1: {  // a pile of books
      double top = z;
      const int books = random.between(1, 4);
      for (int k = 0; k < books; ++k) {
        const BoxSkin skin = all_over(b.tiled(Design::kPaint, static_cast<std::uint64_t>(random.below(12)), 0.5));
        const double inset = random.uniform(0, 0.03);
        b.box(f, {x + inset, x + 0.26}, {y + inset, y + 0.2}, {top, top + 0.035}, skin);
        top += 0.036;
      }
      break;
    }
    default:
      b.sheet(f, {x, x + 0.3}, {y, y + 0.21}, z + 0.004 + 0.001 * number,
              b.fitted(Design::kPaper, static_cast<std::uint64_t>(random.below(40))));
  }
}

void cartons_as_put(Builder& b, const WallFrame& f, const PieceSize& size, Random& random) {
  double s = 0.03;
  while (s + 0.35 < size.width_m) {
    const double w = random.uniform(0.34, 0.5);
    double z = 0;
    const int count = random.between(1, 3);
    for (int i = 0; i < count; ++i) {
      const double h = random.uniform(0.24, 0.38);
      const WallFrame at = f.moved(s + w / 2, size.depth_m / 2).turned(random.uniform(-9, 9));
      const Skin side = b.fitted(Design::kCarton, static_cast<std::uint64_t>(random.below(12)));
      b.box(at, {-w / 2, w / 2}, {-0.18, 0.18}, {z, z + h}, all_over(side));
      z += h;
    }
    s += w + 0.05;
  }
}

void things_as_put(Builder& b, const WallFrame& f, const PieceSize& size, Random& random) {
  double s = 0.03;
  while (s < size.width_m - 0.2) {
    const double wide = random.uniform(0.08, 0.22);
    const double high = random.uniform(0.1, 0.32);
    const Skin side = random.chance(0.4) ? b.fitted(Design::kCarton, static_cast<std::uint64_t>(random.below(12)))
                                         : b.tiled(Design::kPaint, static_cast<std::uint64_t>(random.below(24)), 0.5);
    b.box(f, {s, s + wide}, {0.02, 0.2}, {size.bottom_m + 0.03, size.bottom_m + 0.03 + high}, all_over(side));
    s += wide + random.uniform(0.01, 0.1);
  }
}

}  // namespace

void chair(Builder& b, const WallFrame& f, double s, double t, double angle_deg, std::uint64_t design) {
  if (b.wear().happens(0.12)) return;
  s += b.wear().shift(0.15);
  t += b.wear().shift(0.1);
  const WallFrame at = f.moved(s, t).turned(angle_deg + b.wear().shift(60));
  const BoxSkin fabric = all_over(b.tiled(Design::kFabric, b.wear().other(design % 6, 6, 0.15)));
  const BoxSkin metal = all_over(b.tiled(Design::kMetal, design % 3));
  b.box(at, {-0.23, 0.23}, {-0.23, 0.23}, {0.42, 0.49}, fabric);
  b.box(at, {-0.21, 0.21}, {0.2, 0.26}, {0.58, 1.0}, fabric);
  b.box(at, {-0.03, 0.03}, {0.2, 0.25}, {0.45, 0.6}, metal);
  b.box(at, {-0.03, 0.03}, {-0.03, 0.03}, {0.1, 0.42}, metal);
  b.box(at, {-0.26, 0.26}, {-0.03, 0.03}, {0.04, 0.1}, metal);
  b.box(at, {-0.03, 0.03}, {-0.26, 0.26}, {0.04, 0.1}, metal);
}

void things_on_top(Builder& b, const WallFrame& f, const Span& s, const Span& t, double z, int count, Random& random) {
  for (int i = 0; i < count; ++i) {
    clutter(b, random, 0.75, [&](Builder& to, Random& numbers) { thing_on_top(to, f, s, t, z, i, numbers); });
  }
}

void things_on_shelf(Builder& b, const WallFrame& f, const PieceSize& size, Random& random) {
  clutter(b, random, 0.8, [&](Builder& to, Random& numbers) { things_as_put(to, f, size, numbers); });
}

void cartons(Builder& b, const WallFrame& f, const PieceSize& size, Random& random) {
  clutter(b, random, 0.8, [&](Builder& to, Random& numbers) { cartons_as_put(to, f, size, numbers); });
}

}  // namespace mapweld::rendered
