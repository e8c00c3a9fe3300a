#include "tests/core/geometry/two_view_scene.h"

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

#include <Eigen/Dense>

namespace mapweld::test {
namespace {

constexpr double kFocal_px = 280;
constexpr int kWidth_px = 320;
constexpr int kHeight_px = 240;
constexpr double kPi = 3.14159265358979323846;

class Random {
 public:
  explicit Random(std::uint64_t seed) : engine_(seed) {}
  double uniform(double lo, double hi) { return lo + (hi - lo) * (static_cast<double>(engine_() >> 11) * 0x1p-53); }
  double normal(double sigma) {  // Irwin & Hall
    double sum = -6;
    for (int i = 0; i < 12; ++i) sum += uniform(0, 1);
    return sigma * sum;
  }
  int below(int n) { return static_cast<int>(engine_() % static_cast<std::uint64_t>(n)); }

 private:
  std::mt19937_64 engine_;
};

double wrapped(double angle_deg) {
  const double a = std::fmod(angle_deg, 360.0);
  return a < 0 ? a + 360 : a;
}

float on_grid(double v, double per_unit) { return static_cast<float>(std::round(v * per_unit) / per_unit); }

Appearance appearance(std::uint32_t word, double x, double y, double scale, double angle_deg) {
  return {.word = WordId{word},
          .x_px = on_grid(std::max(x, 0.0), 8),
          .y_px = on_grid(std::max(y, 0.0), 8),
          .scale_px = on_grid(std::max(scale, 0.25), 64),
          .angle_deg = on_grid(wrapped(angle_deg), 65536.0 / 360)};
}

std::array<double, 9> unit(const Eigen::Matrix3d& m) {
  std::array<double, 9> out{};
  const double norm = m.norm();
  for (int r = 0; r < 3; ++r) {
    for (int k = 0; k < 3; ++k) out[3 * r + k] = norm > 0 ? m(r, k) / norm : 0;
  }
  return out;
}

}  // namespace

TwoViewScene make_scene(const SceneOptions& o) {
  Random random(o.seed);
  Eigen::Matrix3d ka;
  ka << kFocal_px, 0, (kWidth_px - 1) / 2.0, 0, kFocal_px, (kHeight_px - 1) / 2.0, 0, 0, 1;
  Eigen::Matrix3d kb = ka;
  kb.topRows(2) *= o.scale_b;
  const double pan = o.pan_deg * kPi / 180;
  const double roll = o.roll_deg * kPi / 180;
  Eigen::Matrix3d turn;
  turn << std::cos(pan), 0, -std::sin(pan), 0, 1, 0, std::sin(pan), 0, std::cos(pan);
  Eigen::Matrix3d tilt;
  tilt << std::cos(roll), -std::sin(roll), 0, std::sin(roll), std::cos(roll), 0, 0, 0, 1;
  const Eigen::Matrix3d rotation = tilt * turn;
  const Eigen::Vector3d centre(o.sideways_m, 0, o.forward_m);
  const Eigen::Vector3d t = -rotation * centre;
  Eigen::Matrix3d cross;
  cross << 0, -t(2), t(1), t(2), 0, -t(0), -t(1), t(0), 0;
  const Eigen::Vector3d normal = Eigen::Vector3d(0.3, -0.1, 1).normalized();
  const double plane_m = 0.5 * (o.nearest_m + o.furthest_m);  // normal . X = plane_m

  TwoViewScene scene;
  scene.a = {.width_px = kWidth_px, .height_px = kHeight_px, .appearances = {}};
  scene.b = {.width_px = static_cast<int>(kWidth_px * o.scale_b),
             .height_px = static_cast<int>(kHeight_px * o.scale_b),
             .appearances = {}};
  scene.fundamental = unit(kb.inverse().transpose() * cross * rotation * ka.inverse());
  scene.homography = unit(kb * (rotation + t * normal.transpose() / (o.flat ? plane_m : 1e12)) * ka.inverse());

  std::uint32_t word = o.first_word;
  std::vector<std::pair<Appearance, Appearance>> seen;
  int repeated = 0;
  while (static_cast<int>(seen.size()) < o.points) {
    const double xa = random.uniform(2, kWidth_px - 3);
    const double ya = random.uniform(2, kHeight_px - 3);
    const Eigen::Vector3d ray = ka.inverse() * Eigen::Vector3d(xa, ya, 1);
    const double depth = o.flat ? plane_m / normal.dot(ray) : random.uniform(o.nearest_m, o.furthest_m);
    const Eigen::Vector3d in_b = rotation * (depth * ray - centre);
    if (in_b(2) < 0.3) continue;
    const Eigen::Vector3d xb = kb * in_b / in_b(2);
    if (xb(0) < 2 || xb(0) > scene.b.width_px - 3 || xb(1) < 2 || xb(1) > scene.b.height_px - 3) continue;
    const double scale = random.uniform(3, 12);
    const double angle = random.uniform(0, 360);
    const double change = o.scale_b * depth / in_b(2) * std::exp(random.normal(0.08));
    // Every third point may share its word with the one before it.
    const bool repeat = repeated < o.repeats && seen.size() % 3 == 1;
    repeated += repeat ? 1 : 0;
    word += repeat ? 0 : 1;
    seen.emplace_back(appearance(word, xa + random.normal(o.noise_px), ya + random.normal(o.noise_px), scale, angle),
                      appearance(word, xb(0) + random.normal(o.noise_px), xb(1) + random.normal(o.noise_px),
                                 scale * change, angle + o.roll_deg + random.normal(5)));
  }
  const auto anywhere = [&](const AppearanceVector& image, std::uint32_t w) {
    return appearance(w, random.uniform(0, image.width_px - 1), random.uniform(0, image.height_px - 1),
                      random.uniform(3, 12), random.uniform(0, 360));
  };
  for (const auto& [p, q] : seen) {
    scene.a.appearances.push_back(p);
    scene.b.appearances.push_back(q);
  }
  for (int i = 0; i < o.outliers; ++i) {
    ++word;
    scene.a.appearances.push_back(anywhere(scene.a, word));
    scene.b.appearances.push_back(anywhere(scene.b, word));
  }
  for (int i = 0; i < o.clutter; ++i) {
    scene.a.appearances.push_back(anywhere(scene.a, ++word));
    scene.b.appearances.push_back(anywhere(scene.b, ++word));
  }
  std::ranges::sort(scene.a.appearances);
  std::ranges::sort(scene.b.appearances);
  const auto index_in = [](const std::vector<Appearance>& all, const Appearance& one) {
    return static_cast<std::uint16_t>(std::ranges::lower_bound(all, one) - all.begin());
  };
  for (const auto& [p, q] : seen) {
    scene.true_matches.emplace(index_in(scene.a.appearances, p), index_in(scene.b.appearances, q));
  }
  return scene;
}

std::pair<AppearanceVector, AppearanceVector> make_chance_pair(const ChanceOptions& o) {
  Random random(o.seed);
  std::pair<AppearanceVector, AppearanceVector> images;
  const auto place = [&](double& x, double& y) {
    switch (o.layout) {
      case Layout::kUniform:
        x = random.uniform(0, kWidth_px - 1);
        y = random.uniform(0, kHeight_px - 1);
        break;
      case Layout::kGrid:  // the corners of doors
        x = 20 + 40 * random.below(8) + random.uniform(-2, 2);
        y = 20 + 40 * random.below(6) + random.uniform(-2, 2);
        break;
      case Layout::kShelves:
        x = random.uniform(0, kWidth_px - 1);
        y = 40 + 40 * random.below(5) + random.uniform(-1, 1);
        break;
      case Layout::kCluster: {  // the far end of a corridor
        const double r = 120 * random.uniform(0, 1) * random.uniform(0, 1);
        const double phi = random.uniform(0, 2 * kPi);
        x = 160 + r * std::cos(phi);
        y = 120 + r * std::sin(phi);
        break;
      }
    }
  };
  for (AppearanceVector* image : {&images.first, &images.second}) {
    image->width_px = kWidth_px;
    image->height_px = kHeight_px;
    for (int i = 0; i < o.matches; ++i) {
      double x = 0;
      double y = 0;
      place(x, y);
      const double scale = o.equal_frames ? 4 : 3 * std::exp(random.uniform(0, 2));
      const double angle = o.equal_frames ? 0 : random.uniform(0, 360);
      image->appearances.push_back(appearance(static_cast<std::uint32_t>(i), x, y, scale, angle));
    }
  }
  return images;
}

double epipolar_distance_px(const std::array<double, 9>& f, const Appearance& a, const Appearance& b) {
  const double x = a.x_px;
  const double y = a.y_px;
  const double l0 = f[0] * x + f[1] * y + f[2];
  const double l1 = f[3] * x + f[4] * y + f[5];
  const double l2 = f[6] * x + f[7] * y + f[8];
  return std::fabs(b.x_px * l0 + b.y_px * l1 + l2) / std::hypot(l0, l1);
}

double transfer_distance_px(const std::array<double, 9>& h, const Appearance& a, const Appearance& b) {
  const double x = a.x_px;
  const double y = a.y_px;
  const double w = h[6] * x + h[7] * y + h[8];
  return std::hypot((h[0] * x + h[1] * y + h[2]) / w - b.x_px, (h[3] * x + h[4] * y + h[5]) / w - b.y_px);
}

}  // namespace mapweld::test
