#include "server/evaluation/truth.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <optional>
#include <sstream>
#include <unordered_map>
#include <utility>

namespace mapweld::server::evaluation {
namespace {

using Fields = std::vector<std::string>;

// Names of images hold no comma and no quote as a rule; a field in double quotes may (RFC 4180).
Fields fields_of(std::string_view line) {
  Fields fields(1);
  bool quoted = false;
  for (std::size_t i = 0; i < line.size(); ++i) {
    const char c = line[i];
    if (c == '"') {
      if (quoted && i + 1 < line.size() && line[i + 1] == '"') {
        fields.back() += line[i++];
      } else {
        quoted = !quoted;
      }
    } else if (c == ',' && !quoted) {
      fields.emplace_back();
    } else if (c != '\r') {
      fields.back() += c;
    }
  }
  return fields;
}

double number_of(const std::string& field) {
  double number = 0;
  const auto [end, error] = std::from_chars(field.data(), field.data() + field.size(), number);
  if (error != std::errc{} || end != field.data() + field.size()) {
    throw TruthError("\"" + field + "\" is not a number");
  }
  return number;
}

using Vertices = std::unordered_map<std::string, std::uint32_t>;

Vertices vertices_of(const NamedMap& map) {
  Vertices vertices;
  for (std::uint32_t v = 0; v < map.images.size(); ++v) vertices.emplace(map.images[v], v);
  return vertices;
}

std::optional<std::uint32_t> find(const Vertices& vertices, const std::string& name) {
  const auto found = vertices.find(name);
  return found == vertices.end() ? std::nullopt : std::optional(found->second);
}

std::string shown(double number) {
  std::ostringstream out;
  out << number;
  return out.str();
}

}  // namespace

class TruthReader {
 public:
  TruthReader(const std::array<NamedMap, 2>& maps, const TruthOptions& options)
      : maps_(maps), options_(options), first_(vertices_of(maps[0])), second_(vertices_of(maps[1])) {}

  Truth read(std::string_view csv) {
    std::istringstream in{std::string(csv)};
    std::string line;
    if (!std::getline(in, line)) throw TruthError("the truth file is empty");
    const Fields header = fields_of(line);
    std::vector<Fields> rows;
    while (std::getline(in, line)) {
      if (line.empty() || line == "\r") continue;
      rows.push_back(fields_of(line));
      if (rows.back().size() < header.size()) throw TruthError("a line has too few fields: " + line);
    }
    truth_.lines_ = rows.size();
    if (column(header, "x_m")) {
      read_poses(header, rows);
    } else {
      read_pairs(header, rows);
    }
    return std::move(truth_);
  }

 private:
  static std::optional<std::size_t> column(const Fields& header, std::string_view name) {
    const auto found = std::ranges::find(header, name);
    if (found == header.end()) return std::nullopt;
    return static_cast<std::size_t>(found - header.begin());
  }
  static std::size_t require(const Fields& header, std::string_view name) {
    const auto found = column(header, name);
    if (!found) throw TruthError("the truth file has no column \"" + std::string(name) + "\"");
    return *found;
  }

  void read_pairs(const Fields& header, const std::vector<Fields>& rows) {
    if (header.size() < 2) throw TruthError("a truth file of pairs has two columns or more");
    const bool is_named = header[0] == "a" && header[1] == "b";
    const auto known = [&](std::size_t a, std::size_t b) {
      return std::ranges::count_if(rows,
                                   [&](const Fields& row) { return find(first_, row[a]) && find(second_, row[b]); });
    };
    const bool is_swapped = !is_named && known(1, 0) > known(0, 1);
    const auto shared = column(header, "shared");
    for (const Fields& row : rows) {
      const auto a = find(first_, row[is_swapped ? 1 : 0]);
      const auto b = find(second_, row[is_swapped ? 0 : 1]);
      if (!a || !b) {
        ++truth_.unknown_lines_;
        continue;
      }
      const double share = shared ? number_of(row[*shared]) : 1;
      const bool right = !shared || share >= options_.min_shared;
      (right ? truth_.right_ : truth_.listed_).emplace(Truth::key(*a, *b), share);
    }
    truth_.is_graded_ = truth_.is_complete_ = shared.has_value();
    truth_.rule_ = shared ? "the two images share at least " + shown(100 * options_.min_shared) + " % of their pixels"
                          : "the pair is listed as one place";
  }

  struct Pose {
    std::uint32_t vertex;
    double x_m, y_m, heading_deg;
    std::string floor;
  };

  void read_poses(const Fields& header, const std::vector<Fields>& rows) {
    const std::size_t name = require(header, "name"), x = require(header, "x_m"), y = require(header, "y_m");
    const auto robot = column(header, "robot"), heading = column(header, "heading_deg"),
               floor = column(header, "floor");
    std::array<std::string, 2> robots{maps_[0].name, maps_[1].name};
    if (robot) {
      const auto has = [&](const std::string& n) {
        return std::ranges::any_of(rows, [&](const Fields& row) { return row[*robot] == n; });
      };
      if (!has(robots[0]) || !has(robots[1])) {
        std::vector<std::string> order;
        for (const Fields& row : rows) {
          if (std::ranges::find(order, row[*robot]) == order.end()) order.push_back(row[*robot]);
        }
        if (order.size() < 2) throw TruthError("the truth file has the poses of fewer than two robots");
        robots = {order[0], order[1]};
      }
    }
    std::array<std::vector<Pose>, 2> poses;
    for (const Fields& row : rows) {
      bool is_known = false;
      for (std::size_t m = 0; m < 2; ++m) {
        if (robot && row[*robot] != robots[m]) continue;
        const auto vertex = find(m == 0 ? first_ : second_, row[name]);
        if (!vertex) continue;
        is_known = true;
        poses[m].push_back({*vertex, number_of(row[x]), number_of(row[y]), heading ? number_of(row[*heading]) : 0,
                            floor ? row[*floor] : ""});
      }
      truth_.unknown_lines_ += is_known ? 0 : 1;
    }
    for (const Pose& a : poses[0]) {
      for (const Pose& b : poses[1]) {
        const double turn_deg = std::abs(std::remainder(a.heading_deg - b.heading_deg, 360.0));
        const double distance_m = std::sqrt((a.x_m - b.x_m) * (a.x_m - b.x_m) + (a.y_m - b.y_m) * (a.y_m - b.y_m));
        if (a.floor == b.floor && distance_m <= options_.max_distance_m && turn_deg <= options_.max_turn_deg) {
          truth_.right_.emplace(Truth::key(a.vertex, b.vertex), 1.0);
        }
      }
    }
    truth_.is_complete_ = true;
    truth_.rule_ = "taken at most " + shown(options_.max_distance_m) + " m apart on one floor, headings within " +
                   shown(options_.max_turn_deg) + " degrees";
  }

  const std::array<NamedMap, 2>& maps_;
  const TruthOptions& options_;
  Vertices first_;
  Vertices second_;
  Truth truth_;
};

Truth Truth::parse(std::string_view csv, const std::array<NamedMap, 2>& maps, const TruthOptions& options) {
  return TruthReader(maps, options).read(csv);
}

std::vector<bool> Truth::placed_in_second(std::uint32_t vertices, double min_shared) const {
  std::vector<bool> placed(vertices, false);
  for (const auto& [pair, share] : right_) {
    if (share >= min_shared) placed.at(pair & 0xFFFFFFFF) = true;
  }
  return placed;
}

}  // namespace mapweld::server::evaluation
