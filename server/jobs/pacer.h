// How often something that costs time may be done: at an interval, but never for more than a share of the time.
#pragma once

#include <algorithm>

namespace mapweld::server {

// Times are seconds of the job's own clock.
class Pacer {
 public:
  // Due at once, then `interval_s` after the last time ended; or, if that took d seconds, d / cost_share later.
  Pacer(double interval_s, double cost_share) : interval_s_(interval_s), cost_share_(cost_share) {}

  bool due(double now_s) const { return now_s >= next_s_; }
  void done(double began_s, double ended_s) {
    next_s_ = ended_s + std::max(interval_s_, (ended_s - began_s) / cost_share_);
  }
  void set_interval(double interval_s) { interval_s_ = interval_s; }
  // Not before an interval from now.
  void put_off(double now_s) { next_s_ = now_s + interval_s_; }

 private:
  double interval_s_;
  double cost_share_;
  double next_s_ = 0;
};

}  // namespace mapweld::server
