#include "tests/support/rendering/wear.h"

#include <algorithm>

#include "tests/support/rendering/builder.h"
#include "tests/support/rendering/shell.h"

namespace mapweld::rendered {
namespace {

constexpr int kCopies = 3;  // of a design of things, on each storey

}  // namespace

Wear::Wear(double amount, std::uint64_t seed, int storey)
    : amount_(amount), own_(hash_of(seed, 101, storey)), random_(own_) {}

bool Wear::happens(double probability) { return !is_none() && random_.chance(probability * amount_); }

double Wear::shift(double most) { return is_none() ? 0 : random_.uniform(-most, most) * amount_; }

std::uint64_t Wear::other(std::uint64_t one, int n, double probability) {
  return happens(probability) ? static_cast<std::uint64_t>(random_.below(n)) : one;
}

std::uint64_t Wear::other_place(std::uint64_t key, double probability) {
  return happens(probability) ? hash_of(own_, key) : key;
}

WornCopy Wear::copy_of(Design design) {
  if (is_none() || design == Design::kMark) return {};
  // Walls, floors and ceilings meet others of their material: they age together.
  const int copy = design <= Design::kCeiling ? 0 : random_.below(kCopies);
  return {hash_of(own_, 102, copy), amount_};
}

double Wear::lamp_power() { return happens(0.12) ? 0 : 1 + shift(0.35); }

void Wear::mark_wall(Builder& builder, const Wall& wall) {
  if (is_none()) return;
  const auto is_open = [&](const Span& s) {
    return std::ranges::any_of(wall.openings, [&](const Opening& o) { return s.from < o.s.to && o.s.from < s.to; });
  };
  for (double s = random_.uniform(0, 0.5); s < wall.length_m - 0.55; s += random_.uniform(0.25, 0.9) / amount_) {
    const double size = random_.uniform(0.25, 0.5);
    const double low = random_.chance(0.3) ? random_.uniform(0.1, 0.4) : random_.uniform(0.5, 2.25);
    const Skin mark = builder.fitted(Design::kMark, random_.next());
    if (!is_open({s, s + size})) builder.panel(wall.frame, {s, s + size}, 0.004, {low, low + size}, mark);
  }
}

void Wear::mark_floor_and_ceiling(Builder& builder) {
  if (is_none()) return;
  const Area& area = builder.cell().area;
  const WallFrame frame = WallFrame::facing({area.x1, area.y0, 0}, {0, 1, 0});
  const auto mark = [&](double z, bool is_floor) {
    const double size = random_.uniform(0.25, 0.5);
    const double s = random_.uniform(0, area.width() - size);
    const double t = random_.uniform(0, area.height() - size);
    const Skin skin = builder.fitted(Design::kMark, random_.next());
    builder.sheet(frame, {s, s + size}, {t, t + size}, z, skin, is_floor);
  };
  const double marks = area.width() * area.height() * amount_;
  for (int i = 0; i < static_cast<int>(marks / 1.5); ++i) mark(0.003, true);
  for (int i = 0; i < static_cast<int>(marks / 5); ++i) mark(builder.cell().height_m - 0.005, false);
}

void Wear::shade(Scene& scene) {
  if (is_none()) return;
  for (const Cell& cell : scene.cells) {
    for (const Surface& s : cell.surfaces) {
      const double whole = 1 + 0.06 * amount_ * random_.gaussian();
      const auto samples = static_cast<std::size_t>(s.light_columns) * static_cast<std::size_t>(s.light_rows);
      for (std::size_t i = s.first_light; i < s.first_light + samples; ++i) {
        const auto factor = static_cast<float>(whole * (1 + 0.05 * amount_ * random_.gaussian()));
        scene.light[i].lamps *= factor;
        scene.light[i].daylight *= factor;
      }
    }
  }
}

}  // namespace mapweld::rendered
