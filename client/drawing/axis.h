// An axis of a chart: round numbers for its ticks, and where a value falls.
#pragma once

#include <string>
#include <vector>

namespace mapweld::drawing {

// From 0 on, with ticks in steps of 1, 2 or 5 times a power of ten, `wanted` of them about.
class Axis {
 public:
  enum class End { kTick, kLast };  // at the first tick at or beyond `most`, or at `most`
  // `from_px` is where 0 falls, `to_px` where the end does.
  Axis(double most, int wanted, double from_px, double to_px, End end = End::kTick);

  double end() const { return end_; }
  double at(double value) const { return from_px_ + (to_px_ - from_px_) * value / end_; }
  const std::vector<double>& ticks() const { return ticks_; }
  // "0.004", "1500": as many decimals as the step needs.
  std::string label(double tick) const;

 private:
  double from_px_;
  double to_px_;
  double step_;
  double end_;
  std::vector<double> ticks_;
};

}  // namespace mapweld::drawing
