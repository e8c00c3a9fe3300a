#include "client/drawing/strands.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <map>
#include <queue>
#include <set>
#include <tuple>
#include <utility>

namespace mapweld::drawing {
namespace {

// Vertices by square cells, for the vertices near a place.
class Cells {
 public:
  Cells(const std::vector<Position>& positions, double size) : positions_(positions), size_(size) {
    for (std::size_t v = 0; v < positions.size(); ++v) cells_[cell(positions[v])].push_back(v);
  }
  template <class Visit>
  void near(const Position& place, Visit visit) const {
    const auto [column, row] = cell(place);
    for (std::int64_t x = column - 1; x <= column + 1; ++x) {
      for (std::int64_t y = row - 1; y <= row + 1; ++y) {
        const auto found = cells_.find({x, y});
        if (found == cells_.end()) continue;
        for (const std::size_t v : found->second) {
          if (std::hypot(positions_[v].x - place.x, positions_[v].y - place.y) <= size_) visit(v);
        }
      }
    }
  }

 private:
  std::pair<std::int64_t, std::int64_t> cell(const Position& p) const {
    return {static_cast<std::int64_t>(std::floor(p.x / size_)), static_cast<std::int64_t>(std::floor(p.y / size_))};
  }
  const std::vector<Position>& positions_;
  double size_;
  std::map<std::pair<std::int64_t, std::int64_t>, std::vector<std::size_t>> cells_;
};

// How far and where a vertex would move: `normal` is a unit vector across the strand, `shift` along it.
struct Move {
  Position normal;
  double shift = 0;
};

Move move_of(std::size_t vertex, const Layout& layout, const Cells& cells, std::span<const std::size_t> group,
             double distance) {
  std::vector<std::size_t> around;
  std::set<std::size_t> groups;
  Position mean;
  cells.near(layout.positions[vertex], [&](std::size_t v) {
    around.push_back(v);
    groups.insert(group[v]);
    mean.x += layout.positions[v].x;
    mean.y += layout.positions[v].y;
  });
  const auto count = static_cast<double>(around.size());
  mean = {mean.x / count, mean.y / count};
  double xx = 0;
  double xy = 0;
  double yy = 0;
  for (const std::size_t v : around) {
    const Position d{layout.positions[v].x - mean.x, layout.positions[v].y - mean.y};
    xx += d.x * d.x;
    xy += d.x * d.y;
    yy += d.y * d.y;
  }
  const double angle = 0.5 * std::atan2(2 * xy, xx - yy);
  const double spread = xx + yy;
  const double direction = spread > 0 ? std::hypot(xx - yy, 2 * xy) / spread : 0;  // 0: a disc, 1: a line
  const auto rank = static_cast<double>(std::distance(groups.begin(), groups.find(group[vertex])));
  const double offset = rank - static_cast<double>(groups.size() - 1) / 2;
  return {{-std::sin(angle), std::cos(angle)}, offset * distance * direction};
}

using Neighbours = std::vector<std::vector<std::size_t>>;

// Turns normals round so that those of neighbours agree, the most parallel ones first.
void orient(std::vector<Move>& moves, const Neighbours& neighbours) {
  std::vector<bool> settled(moves.size(), false);
  using Step = std::tuple<double, std::size_t, std::size_t>;  // how parallel, from, to
  for (std::size_t root = 0; root < moves.size(); ++root) {
    if (settled[root]) continue;
    std::priority_queue<Step> steps;
    steps.push({1, root, root});
    while (!steps.empty()) {
      const auto [parallel, from, to] = steps.top();
      steps.pop();
      if (settled[to]) continue;
      settled[to] = true;
      Position& normal = moves[to].normal;
      if (normal.x * moves[from].normal.x + normal.y * moves[from].normal.y < 0) normal = {-normal.x, -normal.y};
      for (const std::size_t next : neighbours[to]) {
        const Position& other = moves[next].normal;
        if (!settled[next]) steps.push({std::abs(normal.x * other.x + normal.y * other.y), to, next});
      }
    }
  }
}

}  // namespace

void separate_strands(Layout& layout, std::span<const std::size_t> group, std::span<const LayoutEdge> edges,
                      const StrandOptions& options) {
  const std::size_t vertices = layout.positions.size();
  Neighbours neighbours(vertices);
  for (const LayoutEdge& edge : edges) {
    if (edge.u == edge.v) continue;
    neighbours[edge.u].push_back(edge.v);
    neighbours[edge.v].push_back(edge.u);
  }
  const Cells cells(layout.positions, options.reach);
  std::vector<Move> moves(vertices);
  for (std::size_t v = 0; v < vertices; ++v) {
    if (!neighbours[v].empty()) moves[v] = move_of(v, layout, cells, group, options.distance);
  }
  orient(moves, neighbours);

  // A vertex moves as its own group around it moves on average, so that strands stay smooth.
  std::vector<Position> moved = layout.positions;
  for (std::size_t v = 0; v < vertices; ++v) {
    double x = 0;
    double y = 0;
    double count = 0;
    const auto add = [&](std::size_t other) {
      if (group[other] != group[v]) return;
      x += moves[other].normal.x * moves[other].shift;
      y += moves[other].normal.y * moves[other].shift;
      count += 1;
    };
    add(v);
    for (const std::size_t other : neighbours[v]) add(other);
    moved[v].x += x / count;
    moved[v].y += y / count;
  }
  Position corner = moved.empty() ? Position{} : moved[0];
  for (const Position& p : moved) corner = {std::min(corner.x, p.x), std::min(corner.y, p.y)};
  layout.width = 0;
  layout.height = 0;
  for (Position& p : moved) {
    p = {p.x - corner.x, p.y - corner.y};
    layout.width = std::max(layout.width, p.x);
    layout.height = std::max(layout.height, p.y);
  }
  layout.positions = std::move(moved);
}

}  // namespace mapweld::drawing
