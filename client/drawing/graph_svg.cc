#include "client/drawing/graph_svg.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>
#include <vector>

#include "client/drawing/backbone.h"
#include "client/drawing/graph_layout.h"
#include "client/drawing/strands.h"
#include "client/drawing/svg.h"

namespace mapweld::drawing {
namespace {

using contract::Edge;
using contract::Graph;
using contract::Vertex;

constexpr double kMargin = 36;
constexpr double kDrawingWidth = 1100;
constexpr double kMaxDrawingHeight = 1000;
constexpr double kMinDrawingHeight = 160;

constexpr double kMaxUnit = 90;

bool is_inner(const Edge& edge) { return edge.kind != "inter" && edge.confirmed; }
bool is_join(const Edge& edge) { return edge.kind == "inter" && edge.confirmed; }
bool is_doubtful(const Edge& edge) { return !edge.confirmed; }
bool is_doubtful_join(const Edge& edge) { return edge.kind == "inter" && !edge.confirmed; }

struct EdgeStyle {
  const char* colour;
  double width_px;
  double opacity;
  bool dashed;
};

std::string number_of(std::size_t count, const char* one, const char* many) {
  return std::to_string(count) + " " + (count == 1 ? one : many);
}

struct Member {
  std::string name;
  std::string colour;
  std::size_t vertices = 0;
};

// The members in the order of their first vertex, which is the order of the merge.
std::vector<Member> members_of(const Graph& graph, std::map<std::string, std::size_t>& number) {
  std::vector<Member> members;
  for (const Vertex& vertex : graph.vertices) {
    const auto [found, is_new] = number.emplace(vertex.map, members.size());
    if (is_new) members.push_back({vertex.map, kMemberColours[members.size() % kMemberColourCount], 0});
    ++members[found->second].vertices;
  }
  return members;
}

// What stands above the drawing: name, counts, and what each colour means.
class Heading {
 public:
  void title(const std::string& text) {
    content_ += text_at(kMargin, kMargin + 12, text, {.size_px = 20, .bold = true});
  }
  void subtitle(const std::string& text) {
    content_ += text_at(kMargin, kMargin + 34, text, {.size_px = 13, .colour = kFaintInk});
  }
  void entry(const std::string& mark, const std::string& text) {
    const double width = 22 + text_width_px(text, 13) + 26;
    if (x_ > kMargin && x_ + width > kMargin + kDrawingWidth) {
      x_ = kMargin;
      y_ += 22;
    }
    content_ += "<g transform=\"translate(" + px(x_) + " " + px(y_) + ")\">" + mark + "</g>\n";
    content_ += text_at(x_ + 26, y_ + 4.5, text);
    x_ += width;
  }
  double bottom() const { return y_ + 24; }
  const std::string& content() const { return content_; }

 private:
  std::string content_;
  double x_ = kMargin;
  double y_ = kMargin + 60;
};

std::string dot_mark(const std::string& colour) {
  return "<path d=\"M10 -5.5 a5.5 5.5 0 1 0 0.01 0z\" fill=\"" + colour + "\"/>";
}
std::string line_mark(const char* colour, double width, bool dashed) {
  return std::string("<path d=\"M0 0H20\" stroke=\"") + colour + "\" stroke-width=\"" + px(width) + "\"" +
         (dashed ? " stroke-dasharray=\"4 3\"" : "") + "/>";
}

// A graph as it is drawn: edges between vertices that exist, which of them are drawn, positions, members.
struct Drawing {
  const Graph& graph;
  std::vector<const Edge*> edges;
  std::vector<LayoutEdge> ends;  // of `edges`, as indices into graph.vertices
  std::vector<bool> drawn;       // by edge
  bool is_thinned = false;       // confirmed edges are left out
  std::map<std::string, std::size_t> member_number;
  std::vector<Member> members;
  Layout layout;

  Drawing(const Graph& shown, const GraphSvgOptions& options)
      : graph(shown), members(members_of(shown, member_number)) {
    std::map<std::int64_t, std::size_t> index;  // of a vertex number
    for (std::size_t i = 0; i < graph.vertices.size(); ++i) index.emplace(graph.vertices[i].vertex, i);
    for (const Edge& edge : graph.edges) {
      const auto u = index.find(edge.u);
      const auto v = index.find(edge.v);
      if (u == index.end() || v == index.end()) continue;
      edges.push_back(&edge);
      ends.push_back({u->second, v->second});
    }
    choose_edges(options);
    std::vector<LayoutEdge> confirmed;
    for (std::size_t e = 0; e < edges.size(); ++e) {
      if (edges[e]->confirmed) confirmed.push_back(ends[e]);
    }
    layout = layout_graph(graph.vertices.size(), confirmed);
    if (members.size() < 2) return;
    std::vector<std::size_t> group;
    for (const Vertex& vertex : graph.vertices) group.push_back(member_number.at(vertex.map));
    separate_strands(layout, group, confirmed);
  }

  void choose_edges(const GraphSvgOptions& options) {
    const auto confirmed = static_cast<double>(count(is_inner) + count(is_join));
    is_thinned = confirmed > options.dense * static_cast<double>(graph.vertices.size());
    drawn.assign(edges.size(), true);
    for (std::size_t e = 0; e < edges.size(); ++e) drawn[e] = edges[e]->confirmed || options.unconfirmed;
    if (!is_thinned) return;
    for (const auto& [belongs, strongest] :
         {std::pair(&is_inner, options.strongest_inner), std::pair(&is_join, options.strongest_inter)}) {
      std::vector<WeighedEdge> weighed;
      std::vector<std::size_t> place;
      for (std::size_t e = 0; e < edges.size(); ++e) {
        if (!belongs(*edges[e])) continue;
        weighed.push_back({ends[e].u, ends[e].v, static_cast<double>(edges[e]->inliers)});
        place.push_back(e);
      }
      const std::vector<bool> kept = backbone(graph.vertices.size(), weighed, strongest);
      for (std::size_t k = 0; k < place.size(); ++k) drawn[place[k]] = kept[k];
    }
  }

  std::size_t count(bool (*belongs)(const Edge&)) const {
    return static_cast<std::size_t>(
        std::count_if(edges.begin(), edges.end(), [&](const Edge* edge) { return belongs(*edge); }));
  }
  std::size_t count_drawn(bool (*belongs)(const Edge&)) const {
    std::size_t count = 0;
    for (std::size_t e = 0; e < edges.size(); ++e) count += drawn[e] && belongs(*edges[e]) ? 1 : 0;
    return count;
  }
  std::size_t without_edge() const {
    std::vector<bool> has_edge(graph.vertices.size(), false);
    for (std::size_t e = 0; e < edges.size(); ++e) {
      if (edges[e]->confirmed) has_edge[ends[e].u] = has_edge[ends[e].v] = true;
    }
    return static_cast<std::size_t>(std::count(has_edge.begin(), has_edge.end(), false));
  }
};

Heading heading_of(const std::string& name, const Drawing& drawing) {
  const std::size_t inner = drawing.count(is_inner);
  const std::size_t joins = drawing.count(is_join);
  const std::size_t doubtful = drawing.count(is_doubtful);
  const std::size_t doubtful_joins = drawing.count(is_doubtful_join);
  const std::size_t lonely = drawing.without_edge();
  Heading heading;
  heading.title(name);
  std::string counts = number_of(drawing.graph.vertices.size(), "vertex", "vertices");
  if (lonely > 0) counts += " (" + std::to_string(lonely) + " without an edge, in rows at the bottom)";
  counts += ", " + number_of(inner + joins, "edge", "edges");
  if (doubtful > 0) counts += " (" + std::to_string(drawing.edges.size()) + " verified)";
  counts += ". Placed by the graph alone";
  counts += joins > 0 ? "; maps that run together are drawn side by side." : ": near means connected.";
  heading.subtitle(counts);
  const bool merged = drawing.members.size() > 1;
  for (const Member& member : drawing.members) {
    heading.entry(dot_mark(member.colour), member.name + ": " + number_of(member.vertices, "vertex", "vertices"));
  }
  const auto thinned = [&](bool (*belongs)(const Edge&), std::size_t all) {
    const std::size_t drawn = drawing.count_drawn(belongs);
    return drawn < all ? ", the strongest " + std::to_string(drawn) + " drawn" : std::string();
  };
  heading.entry(line_mark(kInnerColour, 1.4, false),
                number_of(inner, "edge", "edges") + (merged ? " within a map" : "") + thinned(is_inner, inner));
  if (merged) {
    heading.entry(line_mark(kInterColour, 1.8, false),
                  number_of(joins, "confirmed edge", "confirmed edges") + " between maps" + thinned(is_join, joins));
  }
  const std::string fate = drawing.count_drawn(is_doubtful) > 0 ? "" : ", left out";
  if (doubtful_joins > 0) {
    heading.entry(line_mark(kInnerColour, 1.4, true),
                  std::to_string(doubtful_joins) + " between maps are verified only" + fate);
  }
  if (doubtful > doubtful_joins) {
    heading.entry(line_mark(kInnerColour, 1.4, true),
                  std::to_string(doubtful - doubtful_joins) + " within a map are verified only" + fate);
  }
  return heading;
}

// From the layout's unit to pixels: as large as the page allows, in its middle.
struct Scale {
  double unit_px;
  double left_px;
  double top_px;
  double height_px;
  double radius_px;  // of a vertex
  double stroke_px;  // of an edge

  Scale(const Layout& layout, double heading_bottom_px)
      : unit_px(std::min({kDrawingWidth / std::max(layout.width, 1e-6),
                          kMaxDrawingHeight / std::max(layout.height, 1e-6), kMaxUnit})),
        left_px(kMargin + (kDrawingWidth - layout.width * unit_px) / 2),
        height_px(std::max(layout.height * unit_px, kMinDrawingHeight)),
        radius_px(std::clamp(0.30 * unit_px, 1.8,
                             std::clamp(80 / std::sqrt(1.0 + static_cast<double>(layout.positions.size())), 1.8, 7.0))),
        stroke_px(std::clamp(0.06 * unit_px, 0.5, 1.4)) {
    top_px = heading_bottom_px + radius_px + (height_px - layout.height * unit_px) / 2;
  }
  Position at(const Position& p) const { return {left_px + p.x * unit_px, top_px + p.y * unit_px}; }
};

std::string draw_edges(const Drawing& drawing, const Scale& scale, bool (*belongs)(const Edge&), const char* class_name,
                       const EdgeStyle& style) {
  std::string content = std::string("<g class=\"") + class_name + "\" stroke=\"" + style.colour + "\" stroke-width=\"" +
                        px(style.width_px) + "\" stroke-opacity=\"" + px(style.opacity) + "\" stroke-linecap=\"round\"";
  content += style.dashed ? " stroke-dasharray=\"4 3\">\n" : ">\n";
  for (std::size_t i = 0; i < drawing.edges.size(); ++i) {
    if (!drawing.drawn[i] || !belongs(*drawing.edges[i])) continue;
    const Position a = scale.at(drawing.layout.positions[drawing.ends[i].u]);
    const Position b = scale.at(drawing.layout.positions[drawing.ends[i].v]);
    content += "<line x1=\"" + px(a.x) + "\" y1=\"" + px(a.y) + "\" x2=\"" + px(b.x) + "\" y2=\"" + px(b.y) + "\"/>\n";
  }
  return content + "</g>\n";
}

std::string draw_vertices(const Drawing& drawing, const Scale& scale) {
  std::string content = "<g class=\"vertices\" stroke=\"#FFFFFF\" stroke-width=\"";
  content += px(std::min(0.8, scale.radius_px / 4)) + "\">\n";
  for (std::size_t i = 0; i < drawing.graph.vertices.size(); ++i) {
    const Vertex& vertex = drawing.graph.vertices[i];
    const Position p = scale.at(drawing.layout.positions[i]);
    content += "<circle cx=\"" + px(p.x) + "\" cy=\"" + px(p.y) + "\" r=\"" + px(scale.radius_px) + "\" fill=\"" +
               drawing.members[drawing.member_number.at(vertex.map)].colour + "\"><title>" +
               escaped(vertex.map + " " + std::to_string(vertex.member_vertex) + ": " + vertex.name) +
               "</title></circle>\n";
  }
  return content + "</g>\n";
}

}  // namespace

std::string graph_svg(const std::string& name, const Graph& graph, const GraphSvgOptions& options) {
  const Drawing drawing(graph, options);
  const Heading heading = heading_of(name, drawing);
  const Scale scale(drawing.layout, heading.bottom());
  const double stroke_px = scale.stroke_px;
  // Many edges a vertex lie on top of one another: fainter ones still show how many.
  const double fade =
      std::clamp(std::sqrt(5.0 * static_cast<double>(graph.vertices.size() + 1) /
                           static_cast<double>(drawing.count_drawn(is_inner) + drawing.count_drawn(is_join) + 1)),
                 0.4, 1.0);
  std::string content = heading.content();
  content += draw_edges(drawing, scale, is_doubtful, "doubtful", {kInnerColour, stroke_px, 0.5, true});
  content += draw_edges(drawing, scale, is_inner, "inner", {kInnerColour, stroke_px, 0.55 * fade, false});
  content += draw_edges(drawing, scale, is_join, "inter", {kInterColour, 1.25 * stroke_px, 0.75 * fade, false});
  content += draw_vertices(drawing, scale);
  const double page_height = heading.bottom() + scale.height_px + 2 * scale.radius_px + kMargin;
  return svg_document(2 * kMargin + kDrawingWidth, page_height, "The graph of map " + name, content);
}

}  // namespace mapweld::drawing
