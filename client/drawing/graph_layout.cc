#include "client/drawing/graph_layout.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <numeric>
#include <stdexcept>
#include <string>

#include <graphviz/gvc.h>

namespace mapweld::drawing {
namespace {

using Edges = std::vector<std::pair<std::size_t, std::size_t>>;

struct Component {
  std::vector<std::size_t> vertices;
  Edges edges;  // of indices into `vertices`
  std::vector<Position> positions;
  double width = 0;
  double height = 0;
};

// The components with an edge, largest first (ties: lowest vertex); and the vertices without one.
struct Parts {
  std::vector<Component> components;
  std::vector<std::size_t> isolated;
};

Parts parts_of(std::size_t vertices, std::span<const std::pair<std::size_t, std::size_t>> edges) {
  std::vector<std::size_t> root(vertices);
  std::iota(root.begin(), root.end(), 0);
  const auto find = [&](std::size_t v) {
    while (root[v] != v) v = root[v] = root[root[v]];
    return v;
  };
  for (const auto& [u, v] : edges) {
    if (u >= vertices || v >= vertices) throw std::invalid_argument("an edge names a vertex that does not exist");
    const std::size_t a = find(u);
    const std::size_t b = find(v);
    root[std::max(a, b)] = std::min(a, b);
  }
  std::vector<Component> by_root(vertices);
  std::vector<std::size_t> place(vertices);
  for (std::size_t v = 0; v < vertices; ++v) {
    Component& component = by_root[find(v)];
    place[v] = component.vertices.size();
    component.vertices.push_back(v);
  }
  for (const auto& [u, v] : edges) {
    if (u != v) by_root[find(u)].edges.emplace_back(std::min(place[u], place[v]), std::max(place[u], place[v]));
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

// Rows of boxes, each row as wide as the layout.
class Shelves {
 public:
  explicit Shelves(Layout& layout, double gap) : layout_(layout), gap_(gap) {}

  // Makes room for a box and returns its corner.
  Position add(double width, double height) {
    if (x_ > 0 && x_ + width > layout_.width) next_row();
    const Position corner{x_, y_};
    x_ += width + gap_;
    row_height_ = std::max(row_height_, height);
    layout_.width = std::max(layout_.width, corner.x + width);
    layout_.height = std::max(layout_.height, y_ + row_height_);
    return corner;
  }
  void next_row() {
    y_ += row_height_ + gap_;
    x_ = 0;
    row_height_ = 0;
  }

 private:
  Layout& layout_;
  double gap_;
  double x_ = 0;
  double y_ = 0;
  double row_height_ = 0;
};

}  // namespace

Layout layout_graph(std::size_t vertices, std::span<const std::pair<std::size_t, std::size_t>> edges) {
  Parts parts = parts_of(vertices, edges);
  Layout layout;
  layout.positions.resize(vertices);
  double area = 0;
  {
    Graphviz graphviz;
    for (Component& component : parts.components) {
      graphviz.place(component);
      straighten(component);
      area += (component.width + 2) * (component.height + 2);
    }
  }
  const double isolated_step = 1.0;
  area += static_cast<double>(parts.isolated.size()) * isolated_step * isolated_step;
  layout.width = 1.3 * std::sqrt(area);
  if (!parts.components.empty()) layout.width = std::max(layout.width, parts.components[0].width);
  Shelves shelves(layout, 1.5);
  for (const Component& component : parts.components) {
    const Position corner = shelves.add(component.width, component.height);
    for (std::size_t i = 0; i < component.vertices.size(); ++i) {
      layout.positions[component.vertices[i]] = {corner.x + component.positions[i].x,
                                                 corner.y + component.positions[i].y};
    }
  }
  if (!parts.components.empty()) shelves.next_row();
  const double top = parts.components.empty() ? 0 : shelves.add(0, 0).y;
  const auto columns = std::max<std::size_t>(1, static_cast<std::size_t>(layout.width / isolated_step));
  for (std::size_t i = 0; i < parts.isolated.size(); ++i) {
    const Position position{static_cast<double>(i % columns) * isolated_step,
                            top + static_cast<double>(i / columns) * isolated_step};
    layout.positions[parts.isolated[i]] = position;
    layout.height = std::max(layout.height, position.y);
  }
  return layout;
}

}  // namespace mapweld::drawing
