#include "client/drawing/graph_svg.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>
#include <vector>

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

bool is_inter(const Edge& edge) { return edge.kind == "inter"; }

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

}  // namespace

std::string graph_svg(const std::string& name, const Graph& graph) {
  std::map<std::int64_t, std::size_t> index;  // of a vertex number
  for (std::size_t i = 0; i < graph.vertices.size(); ++i) index.emplace(graph.vertices[i].vertex, i);
  std::vector<LayoutEdge> pairs;
  std::vector<const Edge*> edges;
  for (const Edge& edge : graph.edges) {
    const auto u = index.find(edge.u);
    const auto v = index.find(edge.v);
    if (u == index.end() || v == index.end()) continue;
    pairs.push_back({u->second, v->second});
    edges.push_back(&edge);
  }
  std::map<std::string, std::size_t> member_number;
  const std::vector<Member> members = members_of(graph, member_number);
  Layout layout = layout_graph(graph.vertices.size(), pairs);
  if (members.size() > 1) {
    std::vector<std::size_t> group;
    for (const Vertex& vertex : graph.vertices) group.push_back(member_number.at(vertex.map));
    separate_strands(layout, group, pairs);
  }
  const auto inter = static_cast<std::size_t>(
      std::count_if(edges.begin(), edges.end(), [](const Edge* e) { return is_inter(*e) && e->confirmed; }));
  const auto doubtful = static_cast<std::size_t>(
      std::count_if(edges.begin(), edges.end(), [](const Edge* e) { return is_inter(*e) && !e->confirmed; }));
  const std::size_t inner = edges.size() - inter - doubtful;

  Heading heading;
  heading.title(name);
  std::vector<bool> has_edge(graph.vertices.size(), false);
  for (const LayoutEdge& pair : pairs) has_edge[pair.u] = has_edge[pair.v] = true;
  const auto lonely = static_cast<std::size_t>(std::count(has_edge.begin(), has_edge.end(), false));
  std::string counts = number_of(graph.vertices.size(), "vertex", "vertices");
  if (lonely > 0) counts += " (" + std::to_string(lonely) + " without an edge, in rows at the bottom)";
  counts += ", " + number_of(edges.size(), "edge", "edges") + ". Placed by the graph alone";
  counts += inter > 0 ? "; maps that run together are drawn side by side." : ": near means connected.";
  heading.subtitle(counts);
  for (const Member& member : members) {
    heading.entry(dot_mark(member.colour), member.name + ": " + number_of(member.vertices, "vertex", "vertices"));
  }
  heading.entry(line_mark(kInnerColour, 1.4, false),
                number_of(inner, "edge", "edges") + (members.size() > 1 ? " within a map" : ""));
  if (members.size() > 1 || inter > 0) {
    heading.entry(line_mark(kInterColour, 1.8, false), number_of(inter, "edge", "edges") + " between maps");
  }
  if (doubtful > 0) {
    heading.entry(line_mark(kInterColour, 1.4, true), std::to_string(doubtful) + " between maps, not confirmed");
  }

  const double width = std::max(layout.width, 1e-6);
  const double height = std::max(layout.height, 1e-6);
  const double unit_px = std::min({kDrawingWidth / width, kMaxDrawingHeight / height, 90.0});
  const double radius_px = std::clamp(0.30 * unit_px, 1.8, 7.0);
  const double drawing_height = std::max(layout.height * unit_px, kMinDrawingHeight);
  const double left = kMargin + (kDrawingWidth - layout.width * unit_px) / 2;
  const double top = heading.bottom() + radius_px + (drawing_height - layout.height * unit_px) / 2;
  const auto at = [&](std::size_t vertex) {
    return Position{left + layout.positions[vertex].x * unit_px, top + layout.positions[vertex].y * unit_px};
  };

  std::string content = heading.content();
  const double stroke_px = std::clamp(0.06 * unit_px, 0.5, 1.4);
  const auto draw_edges = [&](const char* kind, const std::string& style, auto belongs) {
    content += std::string("<g class=\"") + kind + "\" " + style + ">\n";
    for (std::size_t i = 0; i < edges.size(); ++i) {
      if (!belongs(*edges[i])) continue;
      const Position a = at(pairs[i].u);
      const Position b = at(pairs[i].v);
      content +=
          "<line x1=\"" + px(a.x) + "\" y1=\"" + px(a.y) + "\" x2=\"" + px(b.x) + "\" y2=\"" + px(b.y) + "\"/>\n";
    }
    content += "</g>\n";
  };
  const auto stroke = [](const char* colour, double width, double opacity) {
    return std::string("stroke=\"") + colour + "\" stroke-width=\"" + px(width) + "\" stroke-opacity=\"" + px(opacity) +
           "\" stroke-linecap=\"round\"";
  };
  draw_edges("inner", stroke(kInnerColour, stroke_px, 0.55), [](const Edge& e) { return !is_inter(e); });
  draw_edges("doubtful", stroke(kInterColour, stroke_px, 0.5) + " stroke-dasharray=\"4 3\"",
             [](const Edge& e) { return is_inter(e) && !e.confirmed; });
  draw_edges("inter", stroke(kInterColour, 1.25 * stroke_px, 0.75),
             [](const Edge& e) { return is_inter(e) && e.confirmed; });
  content += "<g class=\"vertices\" stroke=\"#FFFFFF\" stroke-width=\"" + px(std::min(0.8, radius_px / 4)) + "\">\n";
  for (std::size_t i = 0; i < graph.vertices.size(); ++i) {
    const Vertex& vertex = graph.vertices[i];
    const Position p = at(i);
    content += "<circle cx=\"" + px(p.x) + "\" cy=\"" + px(p.y) + "\" r=\"" + px(radius_px) + "\" fill=\"" +
               members[member_number.at(vertex.map)].colour + "\"><title>" +
               escaped(vertex.map + " " + std::to_string(vertex.member_vertex) + ": " + vertex.name) +
               "</title></circle>\n";
  }
  content += "</g>\n";
  const double page_height = heading.bottom() + drawing_height + 2 * radius_px + kMargin;
  return svg_document(2 * kMargin + kDrawingWidth, page_height, "The graph of map " + name, content);
}

}  // namespace mapweld::drawing
