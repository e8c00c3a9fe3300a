#include "client/drawing/graph_layout.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <memory>
#include <ranges>
#include <stdexcept>
#include <string>

#include <boost/pending/disjoint_sets.hpp>
#include <graphviz/gvc.h>

#ifdef __SANITIZE_ADDRESS__
// Graphviz never frees what it reads of its configuration.
extern "C" const char* __lsan_default_suppressions() { return "leak:libgvc.so\n"; }
#endif

namespace mapweld::drawing {
namespace {

struct Component {
  std::vector<std::size_t> vertices;
  std::vector<LayoutEdge> edges;  // of indices into `vertices`
  std::vector<Position> positions;
  double width = 0;
  double height = 0;
};

// The components with an edge, largest first (ties: lowest vertex); and the vertices without one.
struct Parts {
  std::vector<Component> components;
  std::vector<std::size_t> isolated;
};

Parts parts_of(std::size_t vertices, std::span<const LayoutEdge> edges) {
  boost::disjoint_sets_with_storage<> sets(vertices);
  for (const auto& [u, v] : edges) {
    if (u >= vertices || v >= vertices) throw std::invalid_argument("an edge names a vertex that does not exist");
    sets.union_set(u, v);
  }
  const auto all = std::views::iota(std::size_t{0}, vertices);
  sets.normalize_sets(all.begin(), all.end());  // now a set's lowest vertex stands for it
  std::vector<Component> by_root(vertices);
  std::vector<std::size_t> place(vertices);
  for (std::size_t v = 0; v < vertices; ++v) {
    Component& component = by_root[sets.find_set(v)];
    place[v] = component.vertices.size();
    component.vertices.push_back(v);
  }
  for (const auto& [u, v] : edges) {
    if (u == v) continue;
    by_root[sets.find_set(u)].edges.push_back({std::min(place[u], place[v]), std::max(place[u], place[v])});
  }
  Parts parts;
  for (Component& component : by_root) {
    if (component.vertices.empty()) continue;
    if (component.vertices.size() == 1) {
      parts.isolated.push_back(component.vertices[0]);
      continue;
    }
    std::sort(component.edges.begin(), component.edges.end());
    component.edges.erase(std::unique(component.edges.begin(), component.edges.end()), component.edges.end());
    parts.components.push_back(std::move(component));
  }
  std::stable_sort(parts.components.begin(), parts.components.end(),
                   [](const Component& a, const Component& b) { return a.vertices.size() > b.vertices.size(); });
  return parts;
}

// A Graphviz context; the plugins it needs are loaded with it.
class Graphviz {
 public:
  Graphviz() : context_(gvContext()) {}
  ~Graphviz() { gvFreeContext(context_); }
  Graphviz(const Graphviz&) = delete;
  Graphviz& operator=(const Graphviz&) = delete;

  void place(Component& component) {
    const std::unique_ptr<Agraph_t, int (*)(Agraph_t*)> graph(
        agopen(writable("component"), Agstrictundirected, nullptr), &agclose);
    set(graph.get(), AGRAPH, "overlap", "true");   // positions only: nothing needs room
    set(graph.get(), AGRAPH, "splines", "false");  // edges are ours to draw
    set(graph.get(), AGRAPH, "start", "1");        // the seed
    set(graph.get(), AGNODE, "shape", "point");
    set(graph.get(), AGNODE, "label", "");
    std::vector<Agnode_t*> nodes;
    for (std::size_t i = 0; i < component.vertices.size(); ++i) {
      nodes.push_back(agnode(graph.get(), writable(std::to_string(i)), 1));
    }
    for (const auto& [a, b] : component.edges) agedge(graph.get(), nodes[a], nodes[b], nullptr, 1);
    std::srand(1);  // sfdp's coarsening draws from rand() before it seeds it
    if (gvLayout(context_, graph.get(), "sfdp") != 0) {
      throw std::runtime_error("Graphviz cannot lay out the graph: its sfdp plugin is missing (Debian: libgvc6).");
    }
    for (Agnode_t* node : nodes) component.positions.push_back({ND_coord(node).x, ND_coord(node).y});
    gvFreeLayout(context_, graph.get());
  }

 private:
  // The C API of Graphviz takes char* for what it does not change.
  static char* writable(const std::string& text) { return const_cast<char*>(text.c_str()); }
  static void set(Agraph_t* graph, int of, const std::string& name, const std::string& value) {
    agattr(graph, of, writable(name), writable(value));
  }

  GVC_t* context_;
};

// Turns the positions so that their principal axis lies, the vertex named first on the left, and scales them so that
// the median edge has length 1.
void straighten(Component& component) {
  std::vector<Position>& positions = component.positions;
  Position mean;
  for (const Position& p : positions) {
    mean.x += p.x / static_cast<double>(positions.size());
    mean.y += p.y / static_cast<double>(positions.size());
  }
  double xx = 0;
  double xy = 0;
  double yy = 0;
  for (const Position& p : positions) {
    xx += (p.x - mean.x) * (p.x - mean.x);
    xy += (p.x - mean.x) * (p.y - mean.y);
    yy += (p.y - mean.y) * (p.y - mean.y);
  }
  double angle = 0.5 * std::atan2(2 * xy, xx - yy);
  const auto along = [&](const Position& p) {
    return (p.x - mean.x) * std::cos(angle) + (p.y - mean.y) * std::sin(angle);
  };
  if (along(positions[0]) > 0) angle += std::acos(-1.0);
  for (Position& p : positions) {
    const double x = along(p);
    p = {x, (p.y - mean.y) * std::cos(angle) - (p.x - mean.x) * std::sin(angle)};
  }
  std::vector<double> lengths;
  for (const auto& [a, b] : component.edges) {
    lengths.push_back(std::hypot(positions[a].x - positions[b].x, positions[a].y - positions[b].y));
  }
  std::nth_element(lengths.begin(), lengths.begin() + static_cast<std::ptrdiff_t>(lengths.size() / 2), lengths.end());
  const double unit = std::max(lengths[lengths.size() / 2], 1e-9);
  const auto [left, right] =
      std::minmax_element(positions.begin(), positions.end(), [](auto& a, auto& b) { return a.x < b.x; });
  const auto [top, bottom] =
      std::minmax_element(positions.begin(), positions.end(), [](auto& a, auto& b) { return a.y < b.y; });
  const Position corner{left->x, top->y};
  component.width = (right->x - left->x) / unit;
  component.height = (bottom->y - top->y) / unit;
  for (Position& p : positions) p = {(p.x - corner.x) / unit, (p.y - corner.y) / unit};
}

// Packs boxes into a strip of a given width, each as high up as the boxes before it allow (a skyline: the lower edge of
// what has been placed, as steps from left to right).
class Skyline {
 public:
  explicit Skyline(double width) : width_(width), steps_{{0, 0}} {}

  Position add(double box_width, double box_height) {
    Position best{0, std::numeric_limits<double>::infinity()};
    for (const Position& step : steps_) {
      if (step.x > 0 && step.x + box_width > width_) break;
      const double y = depth(step.x, step.x + box_width);
      if (y < best.y) best = {step.x, y};
    }
    cover(best.x, best.x + box_width, best.y + box_height);
    height_ = std::max(height_, best.y + box_height);
    return best;
  }
  double height() const { return height_; }

 private:
  // How far down the skyline reaches between two places.
  double depth(double from, double to) const {
    double deepest = 0;
    for (std::size_t i = 0; i < steps_.size(); ++i) {
      const double end = i + 1 < steps_.size() ? steps_[i + 1].x : std::numeric_limits<double>::infinity();
      if (steps_[i].x < to && end > from) deepest = std::max(deepest, steps_[i].y);
    }
    return deepest;
  }

  void cover(double from, double to, double y) {
    std::vector<Position> steps;
    double after = 0;  // the depth that goes on behind the box
    for (const Position& step : steps_) {
      if (step.x <= to) after = step.y;
      if (step.x < from || step.x > to) steps.push_back(step);
    }
    steps.push_back({from, y});
    steps.push_back({to, after});
    std::sort(steps.begin(), steps.end(), [](const Position& a, const Position& b) { return a.x < b.x; });
    steps_ = std::move(steps);
  }

  double width_;
  double height_ = 0;
  std::vector<Position> steps_;
};

constexpr double kGap = 1.5;           // between components, in edge lengths
constexpr double kIsolatedStep = 1.0;  // between vertices without edges
constexpr double kAspect = 1.5;        // width to height of the whole that is aimed at

// Packs the components into a strip of this width; returns their corners and the height.
std::pair<std::vector<Position>, double> packed(const std::vector<Component>& components, double width) {
  Skyline skyline(width);
  std::vector<Position> corners;
  for (const Component& component : components) {
    corners.push_back(skyline.add(component.width + kGap, component.height + kGap));
  }
  return {std::move(corners), skyline.height()};
}

}  // namespace

Layout layout_graph(std::size_t vertices, std::span<const LayoutEdge> edges) {
  Parts parts = parts_of(vertices, edges);
  Layout layout;
  layout.positions.resize(vertices);
  {
    Graphviz graphviz;
    for (Component& component : parts.components) {
      graphviz.place(component);
      straighten(component);
    }
  }
  double widest = 1;
  double area = static_cast<double>(parts.isolated.size()) * kIsolatedStep * kIsolatedStep;
  for (const Component& component : parts.components) {
    widest = std::max(widest, component.width + kGap);
    area += (component.width + kGap) * (component.height + kGap);
  }
  // Of some widths, the one whose packing comes closest to the aspect wanted without being much larger.
  double best_cost = std::numeric_limits<double>::infinity();
  std::vector<Position> corners;
  for (const double factor : {0.8, 0.9, 1.0, 1.15, 1.3, 1.5, 1.75, 2.0}) {
    const double width = std::max(widest, factor * std::sqrt(kAspect * area));
    auto [candidate, height] = packed(parts.components, width);
    const double cost = std::max(width, kAspect * height);
    if (cost < best_cost) {
      best_cost = cost;
      layout.width = width;
      layout.height = height;
      corners = std::move(candidate);
    }
  }
  for (std::size_t c = 0; c < parts.components.size(); ++c) {
    const Component& component = parts.components[c];
    for (std::size_t i = 0; i < component.vertices.size(); ++i) {
      layout.positions[component.vertices[i]] = {corners[c].x + component.positions[i].x,
                                                 corners[c].y + component.positions[i].y};
    }
  }
  const double top = layout.height;
  const auto columns = std::max<std::size_t>(1, static_cast<std::size_t>(layout.width / kIsolatedStep));
  for (std::size_t i = 0; i < parts.isolated.size(); ++i) {
    layout.positions[parts.isolated[i]] = {static_cast<double>(i % columns) * kIsolatedStep,
                                           top + static_cast<double>(i / columns) * kIsolatedStep};
  }
  // The box that is really used.
  layout.width = 0;
  layout.height = 0;
  for (const Position& position : layout.positions) {
    layout.width = std::max(layout.width, position.x);
    layout.height = std::max(layout.height, position.y);
  }
  return layout;
}

}  // namespace mapweld::drawing
