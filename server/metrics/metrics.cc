#include "server/metrics/metrics.h"

#include <algorithm>
#include <cstdio>

namespace mapweld::server {
namespace {

std::string number(double value) {
  char text[32];
  std::snprintf(text, sizeof(text), "%.9g", value);
  return text;
}

double quantile(std::vector<float>& values, double q) {
  if (values.empty()) return 0;
  const auto rank = static_cast<std::size_t>(q * static_cast<double>(values.size() - 1) + 0.5);
  std::nth_element(values.begin(), values.begin() + static_cast<std::ptrdiff_t>(rank), values.end());
  return values[rank];
}

void head(std::string& out, const std::string& name, const std::string& help, const std::string& type) {
  out += "# HELP " + name + " " + help + "\n# TYPE " + name + " " + type + "\n";
}

}  // namespace

std::string_view to_string(Stage stage) {
  switch (stage) {
    case Stage::kDecode:
      return "decode";
    case Stage::kSift:
      return "sift";
    case Stage::kQuantise:
      return "quantise";
    case Stage::kVote:
      return "vote";
    case Stage::kVerify:
      return "verify";
    case Stage::kCommit:
      return "commit";
  }
  return "";
}

void DurationSeries::record(double seconds) {
  const std::lock_guard lock(mutex_);
  if (window_.size() < kWindow) {
    window_.push_back(static_cast<float>(seconds));
  } else {
    window_[count_ % kWindow] = static_cast<float>(seconds);
  }
  ++count_;
  sum_s_ += seconds;
}

DurationSeries::Summary DurationSeries::summary() const {
  std::vector<float> values;
  Summary summary;
  {
    const std::lock_guard lock(mutex_);
    values = window_;
    summary.count = count_;
    summary.sum_s = sum_s_;
  }
  summary.median_s = quantile(values, 0.5);
  summary.p90_s = quantile(values, 0.9);
  summary.p99_s = quantile(values, 0.99);
  return summary;
}

void Metrics::count_request(const std::string& method, const std::string& route, int status, double seconds) {
  const std::lock_guard lock(requests_mutex_);
  RequestCount& request = requests_[{method, route, status}];
  ++request.count;
  request.sum_s += seconds;
}

void Metrics::add_gauge(std::string name, std::string help, std::function<double()> value) {
  asked_.push_back({std::move(name), std::move(help), "gauge", "", [value = std::move(value)] {
                      return Labelled{{"", value()}};
                    }});
}

void Metrics::add_counter(std::string name, std::string help, std::function<double()> value) {
  add_gauge(std::move(name), std::move(help), std::move(value));
  asked_.back().type = "counter";
}

void Metrics::add_gauges(std::string name, std::string help, std::string label, std::function<Labelled()> values) {
  asked_.push_back({std::move(name), std::move(help), "gauge", std::move(label), std::move(values)});
}

std::string Metrics::prometheus_text() const {
  std::string out;
  head(out, "mapweld_stage_duration_seconds", "Time an image spends in a stage; quantiles of the last 2048.",
       "summary");
  for (const Stage stage : kStages) {
    const DurationSeries::Summary summary = stages_[static_cast<std::size_t>(stage)].summary();
    const std::string label = "stage=\"" + std::string(to_string(stage)) + "\"";
    const std::string name = "mapweld_stage_duration_seconds";
    out += name + "{" + label + ",quantile=\"0.5\"} " + number(summary.median_s) + "\n";
    out += name + "{" + label + ",quantile=\"0.9\"} " + number(summary.p90_s) + "\n";
    out += name + "{" + label + ",quantile=\"0.99\"} " + number(summary.p99_s) + "\n";
    out += name + "_sum{" + label + "} " + number(summary.sum_s) + "\n";
    out += name + "_count{" + label + "} " + std::to_string(summary.count) + "\n";
  }
  {
    const std::lock_guard lock(requests_mutex_);
    head(out, "mapweld_http_requests_total", "Requests answered.", "counter");
    for (const auto& [key, request] : requests_) {
      const auto& [method, route, status] = key;
      out += "mapweld_http_requests_total{method=\"" + method + "\",route=\"" + route + "\",status=\"" +
             std::to_string(status) + "\"} " + std::to_string(request.count) + "\n";
    }
    head(out, "mapweld_http_request_duration_seconds_total", "Time spent on requests.", "counter");
    for (const auto& [key, request] : requests_) {
      const auto& [method, route, status] = key;
      out += "mapweld_http_request_duration_seconds_total{method=\"" + method + "\",route=\"" + route + "\",status=\"" +
             std::to_string(status) + "\"} " + number(request.sum_s) + "\n";
    }
  }
  for (const Asked& asked : asked_) {
    const std::string name = "mapweld_" + asked.name;
    head(out, name, asked.help, asked.type);
    for (const auto& [value, amount] : asked.values()) {
      out += name;
      if (!asked.label.empty()) out.append("{").append(asked.label).append("=\"").append(value).append("\"}");
      out += " " + number(amount) + "\n";
    }
  }
  return out;
}

}  // namespace mapweld::server
