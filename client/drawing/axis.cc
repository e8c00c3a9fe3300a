#include "client/drawing/axis.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

namespace mapweld::drawing {

Axis::Axis(double most, int wanted, double from_px, double to_px, End end) : from_px_(from_px), to_px_(to_px) {
  if (!(most > 0)) most = 1;
  const double rough = most / std::max(1, wanted);
  const double power = std::pow(10.0, std::floor(std::log10(rough)));
  const double lead = rough / power;
  step_ = power * (lead <= 1.0001 ? 1 : lead <= 2.0001 ? 2 : lead <= 5.0001 ? 5 : 10);
  const int steps = std::max(1, static_cast<int>(std::ceil(most / step_ - 1e-9)));
  end_ = end == End::kTick ? steps * step_ : most;
  for (int i = 0; i <= steps; ++i) {
    if (i * step_ <= end_ * (1 + 1e-9)) ticks_.push_back(i * step_);
  }
}

std::string Axis::label(double tick) const {
  char text[48];
  if (tick != 0 && (end_ < 1e-4 || end_ >= 1e7)) {
    std::snprintf(text, sizeof text, "%.3g", tick);
  } else {
    const int decimals = std::max(0, static_cast<int>(std::ceil(-std::log10(step_) - 1e-9)));
    std::snprintf(text, sizeof text, "%.*f", decimals, tick);
  }
  return text;
}

}  // namespace mapweld::drawing
