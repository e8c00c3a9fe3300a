// What the server counts and times, and how /metrics shows it (Prometheus text format, version 0.0.4).
#pragma once

#include <array>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <functional>
#include <map>
#include <mutex>
#include <string>
#include <string_view>
#include <tuple>
#include <vector>

namespace mapweld::server {

// The stages that an uploaded image goes through (docs/operations.md, "Stages").
enum class Stage : std::uint8_t { kDecode, kSift, kQuantise, kVote, kVerify, kCommit };
inline constexpr std::array kStages = {Stage::kDecode, Stage::kSift,   Stage::kQuantise,
                                       Stage::kVote,   Stage::kVerify, Stage::kCommit};
std::string_view to_string(Stage stage);

// Durations of one kind: their number and sum since the start, and the quantiles of the last `kWindow` of them.
// Thread-safe; recording takes well under a microsecond.
class DurationSeries {
 public:
  static constexpr std::size_t kWindow = 2048;

  void record(double seconds);

  struct Summary {
    std::uint64_t count = 0;
    double sum_s = 0;
    // Of the window; 0 when nothing was recorded.
    double median_s = 0;
    double p90_s = 0;
    double p99_s = 0;
  };
  Summary summary() const;

 private:
  mutable std::mutex mutex_;
  std::uint64_t count_ = 0;
  double sum_s_ = 0;
  std::vector<float> window_;  // a ring
};

// Thread-safe.
class Metrics {
 public:
  DurationSeries& stage(Stage stage) { return stages_[static_cast<std::size_t>(stage)]; }

  // A request that was answered. `route` is the pattern, so that there are no more series than routes.
  void count_request(const std::string& method, const std::string& route, int status, double seconds);

  // A value that is asked for when it is shown. `name` without the prefix "mapweld_". Before the server starts.
  void add_gauge(std::string name, std::string help, std::function<double()> value);
  // One that only grows; its name ends in "_total".
  void add_counter(std::string name, std::string help, std::function<double()> value);
  // Gauges of one name, told apart by a label: its value -> the number.
  using Labelled = std::map<std::string, double>;
  void add_gauges(std::string name, std::string help, std::string label, std::function<Labelled()> values);

  std::string prometheus_text() const;

 private:
  std::array<DurationSeries, kStages.size()> stages_;

  struct Asked {
    std::string name;
    std::string help;
    std::string type;
    std::string label;  // empty: none, and one number under ""
    std::function<Labelled()> values;
  };
  std::vector<Asked> asked_;

  struct RequestCount {
    std::uint64_t count = 0;
    double sum_s = 0;
  };
  mutable std::mutex requests_mutex_;
  std::map<std::tuple<std::string, std::string, int>, RequestCount> requests_;
};

// Milliseconds as answers show them, to the microsecond.
inline double shown_ms(double seconds) { return std::round(seconds * 1e6) / 1e3; }

// Time that passes, in seconds.
class Stopwatch {
 public:
  double elapsed_s() const {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - started_).count();
  }
  // Time since the start or the last lap.
  double lap_s() {
    const auto now = std::chrono::steady_clock::now();
    const double lap = std::chrono::duration<double>(now - lap_).count();
    lap_ = now;
    return lap;
  }

 private:
  std::chrono::steady_clock::time_point started_ = std::chrono::steady_clock::now();
  std::chrono::steady_clock::time_point lap_ = started_;
};

}  // namespace mapweld::server
