// The figure of a graph: well-formed, complete, repeatable, and laid out so that it can be read.
#include "client/drawing/graph_svg.h"

#include <cmath>
#include <regex>
#include <set>

#include <gtest/gtest.h>

#include "client/drawing/graph_layout.h"
#include "client/drawing/strands.h"
#include "client/drawing/svg.h"
#include "tests/client/drawing/well_formed.h"

namespace mapweld::drawing {
namespace {

using mapweld::testing::count_elements;
using mapweld::testing::element_of_class;
using mapweld::testing::xml_fault;

// Two robots in one corridor: `a` and `b` images, neighbours joined, every fourth one joined with the other map's, the
// last `lonely` of each without an edge.
contract::Graph corridor(int a, int b, int lonely = 0) {
  contract::Graph graph;
  for (int i = 0; i < a + b; ++i) {
    contract::Vertex vertex;
    vertex.vertex = i;
    vertex.name = std::to_string(i) + ".jpg";
    vertex.map = i < a ? "lab-a" : "lab-b";
    vertex.member_vertex = i < a ? i : i - a;
    graph.vertices.push_back(vertex);
  }
  const auto join = [&](int u, int v, const char* kind) {
    contract::Edge edge;
    edge.u = u;
    edge.v = v;
    edge.kind = kind;
    graph.edges.push_back(edge);
  };
  for (const auto& [first, count] : {std::pair(0, a - lonely), std::pair(a, b - lonely)}) {
    for (int i = 0; i + 1 < count; ++i) join(first + i, first + i + 1, "inner");
    for (int i = 0; i + 2 < count; ++i) join(first + i, first + i + 2, "inner");
  }
  for (int i = 0; i < std::min(a, b) - lonely; i += 4) join(i, a + i, "inter");
  return graph;
}

std::vector<LayoutEdge> edges_of(const contract::Graph& graph) {
  std::vector<LayoutEdge> edges;
  for (const auto& edge : graph.edges) {
    edges.push_back({static_cast<std::size_t>(edge.u), static_cast<std::size_t>(edge.v)});
  }
  return edges;
}

double distance(const Position& a, const Position& b) { return std::hypot(a.x - b.x, a.y - b.y); }

TEST(GraphSvg, ShowsEveryVertexAndEdgeAtManySizes) {
  for (const auto& [a, b, lonely] : {std::tuple(12, 8, 1), std::tuple(60, 40, 3), std::tuple(1356, 610, 5)}) {
    const contract::Graph graph = corridor(a, b, lonely);
    const std::string svg = graph_svg("lab", graph);
    EXPECT_EQ(xml_fault(svg), "");
    EXPECT_EQ(count_elements(element_of_class(svg, "vertices"), "circle"), graph.vertices.size());
    std::size_t inter = 0;
    for (const auto& edge : graph.edges) inter += edge.kind == "inter" ? 1 : 0;
    EXPECT_EQ(count_elements(element_of_class(svg, "inter"), "line"), inter);
    EXPECT_EQ(count_elements(element_of_class(svg, "inner"), "line"), graph.edges.size() - inter);
    EXPECT_NE(svg.find("lab-a: " + std::to_string(a) + " vertices"), std::string::npos);
    EXPECT_NE(svg.find("(" + std::to_string(2 * lonely) + " without an edge"), std::string::npos);
  }
}

TEST(GraphSvg, StaysWithinItsPage) {
  const std::string svg = graph_svg("lab", corridor(60, 40, 3));
  std::smatch page;
  ASSERT_TRUE(std::regex_search(svg, page, std::regex("viewBox=\"0 0 ([0-9.]+) ([0-9.]+)\"")));
  const std::regex circle("cx=\"([-0-9.]+)\" cy=\"([-0-9.]+)\"");
  for (std::sregex_iterator i(svg.begin(), svg.end(), circle), none; i != none; ++i) {
    EXPECT_GE(std::stod((*i)[1]), 0);
    EXPECT_GE(std::stod((*i)[2]), 0);
    EXPECT_LE(std::stod((*i)[1]), std::stod(page[1]));
    EXPECT_LE(std::stod((*i)[2]), std::stod(page[2]));
  }
}

TEST(GraphSvg, TakesEmptyAndTinyGraphs) {
  EXPECT_EQ(xml_fault(graph_svg("empty", {})), "");
  EXPECT_EQ(xml_fault(graph_svg("one", corridor(1, 0))), "");
  EXPECT_EQ(xml_fault(graph_svg("none-joined", corridor(3, 3, 3))), "");
}

TEST(GraphSvg, TellsWhatIsOnlyVerifiedFromTheEdgesOfTheMap) {
  contract::Graph graph = corridor(8, 8);
  const std::string before = graph_svg("lab", graph);
  for (auto& edge : graph.edges) edge.confirmed = edge.kind != "inter";
  contract::Edge inner;
  inner.u = 0;
  inner.v = 7;
  inner.confirmed = false;
  graph.edges.push_back(inner);
  // Left out, and counted.
  const std::string svg = graph_svg("lab", graph);
  EXPECT_EQ(xml_fault(svg), "");
  EXPECT_EQ(count_elements(element_of_class(svg, "doubtful"), "line"), 0U);
  EXPECT_EQ(count_elements(element_of_class(svg, "inter"), "line"), 0U);
  EXPECT_EQ(count_elements(element_of_class(svg, "inner"), "line"), 26U);
  EXPECT_NE(svg.find("26 edges (29 verified)"), std::string::npos) << svg;
  EXPECT_NE(svg.find("0 confirmed edges between maps"), std::string::npos);
  EXPECT_NE(svg.find("2 between maps are verified only, left out"), std::string::npos);
  EXPECT_NE(svg.find("1 within a map are verified only, left out"), std::string::npos);
  EXPECT_EQ(before.find("verified only"), std::string::npos);
  // Drawn when asked for: below the others, dashed, never in the red of a join.
  const std::string drawn = graph_svg("lab", graph, {.unconfirmed = true});
  const std::string doubtful(element_of_class(drawn, "doubtful"));
  EXPECT_EQ(count_elements(doubtful, "line"), 3U);
  EXPECT_NE(doubtful.find("stroke-dasharray"), std::string::npos);
  EXPECT_EQ(doubtful.find(kInterColour), std::string::npos);
  EXPECT_LT(drawn.find("class=\"doubtful\""), drawn.find("class=\"inner\""));
  EXPECT_EQ(drawn.find("left out"), std::string::npos);
  // What is not confirmed draws nothing near: the two maps stand as they would without it.
  contract::Graph without = graph;
  std::erase_if(without.edges, [](const auto& edge) { return !edge.confirmed; });
  const auto places = [](const std::string& figure) {  // across the page; the legend has a row more or less
    return std::regex_replace(std::string(element_of_class(figure, "vertices")), std::regex(" cy=\"[^\"]*\""), "");
  };
  EXPECT_EQ(places(drawn), places(graph_svg("lab", without)));
}

TEST(GraphSvg, ThinsOutADenseRoomAndSaysSo) {
  // Two robots in one room: everybody sees nearly everything.
  contract::Graph graph = corridor(50, 40);
  graph.edges.clear();
  for (int u = 0; u < 90; ++u) {
    for (int v = u + 1; v < 90; ++v) {
      if ((u * 7 + v * 13) % 3 == 0) continue;
      contract::Edge edge;
      edge.u = u;
      edge.v = v;
      edge.kind = u < 50 && v >= 50 ? "inter" : "inner";
      edge.inliers = 200 - std::abs(u % 50 - v % 50);
      graph.edges.push_back(edge);
    }
  }
  const std::string svg = graph_svg("room", graph);
  EXPECT_EQ(xml_fault(svg), "");
  const std::size_t inter = count_elements(element_of_class(svg, "inter"), "line");
  const std::size_t inner = count_elements(element_of_class(svg, "inner"), "line");
  EXPECT_LE(inter, 90U);
  EXPECT_GE(inter, 45U);
  EXPECT_LE(inner, 270U);
  EXPECT_NE(svg.find(" between maps, the strongest " + std::to_string(inter) + " drawn"), std::string::npos);
  EXPECT_NE(svg.find(" within a map, the strongest " + std::to_string(inner) + " drawn"), std::string::npos);
  EXPECT_NE(svg.find(std::to_string(graph.edges.size()) + " edges. "), std::string::npos);
  EXPECT_EQ(count_elements(element_of_class(svg, "vertices"), "circle"), 90U);
  const std::string whole = graph_svg("room", graph, {.dense = 1000});
  EXPECT_EQ(count_elements(element_of_class(whole, "inter"), "line") +
                count_elements(element_of_class(whole, "inner"), "line"),
            graph.edges.size());
}

TEST(GraphSvg, EscapesNames) {
  contract::Graph graph = corridor(4, 4);
  graph.vertices[0].name = "<script>&\"'\x01\xff.jpg";
  const std::string svg = graph_svg("a<b&c", graph);
  EXPECT_EQ(xml_fault(svg), "");
  EXPECT_EQ(svg.find("<script>"), std::string::npos);
  EXPECT_NE(svg.find("&lt;script&gt;&amp;&quot;'\xEF\xBF\xBD\xEF\xBF\xBD.jpg"), std::string::npos);
}

TEST(GraphSvg, IsTheSameEveryTime) {
  const contract::Graph graph = corridor(60, 40, 3);
  EXPECT_TRUE(graph_svg("lab", graph) == graph_svg("lab", graph));
}

TEST(GraphLayout, KeepsNeighboursNearAndComponentsApart) {
  const contract::Graph graph = corridor(80, 40);
  std::vector<LayoutEdge> inner;
  for (const auto& edge : graph.edges) {
    if (edge.kind == "inner") inner.push_back({static_cast<std::size_t>(edge.u), static_cast<std::size_t>(edge.v)});
  }
  const Layout layout = layout_graph(120, inner);
  for (const LayoutEdge& edge : inner) EXPECT_LT(distance(layout.positions[edge.u], layout.positions[edge.v]), 4);
  EXPECT_GT(distance(layout.positions[0], layout.positions[79]), 15);
  for (std::size_t u = 0; u < 80; ++u) {
    for (std::size_t v = 80; v < 120; ++v) EXPECT_GT(distance(layout.positions[u], layout.positions[v]), 1) << u << v;
  }
  std::set<std::pair<double, double>> places;
  for (const Position& p : layout.positions) {
    EXPECT_TRUE(p.x >= 0 && p.x <= layout.width && p.y >= 0 && p.y <= layout.height);
    places.insert({p.x, p.y});
  }
  EXPECT_EQ(places.size(), 120U);
  EXPECT_THROW(layout_graph(2, std::vector<LayoutEdge>{{0, 2}}), std::invalid_argument);
}

TEST(Strands, MapsThatRunTogetherComeToLieSideBySide) {
  const contract::Graph graph = corridor(200, 200);
  const std::vector<LayoutEdge> edges = edges_of(graph);
  std::vector<std::size_t> group(400, 0);
  std::fill(group.begin() + 200, group.end(), 1);
  const auto nearest_other = [&](const Layout& layout) {
    double sum = 0;
    for (std::size_t u = 0; u < 200; ++u) {
      double nearest = 1e9;
      for (std::size_t v = 200; v < 400; ++v) {
        nearest = std::min(nearest, distance(layout.positions[u], layout.positions[v]));
      }
      sum += nearest;
    }
    return sum / 200;
  };
  Layout layout = layout_graph(400, edges);
  const double before = nearest_other(layout);
  separate_strands(layout, group, edges);
  EXPECT_GT(nearest_other(layout), before + 0.7);
  // Neighbours in a strand stay neighbours: no strand jumps from one side to the other.
  for (std::size_t v = 0; v + 1 < 200; ++v) EXPECT_LT(distance(layout.positions[v], layout.positions[v + 1]), 3) << v;
}

// Round a block, whichever way it is drawn, the strands never change sides.
TEST(Strands, KeepTheirSideAllTheWayRound) {
  constexpr std::size_t kRound = 160;
  std::vector<LayoutEdge> edges;
  for (std::size_t i = 0; i < kRound; ++i) {
    for (const std::size_t step : {1U, 2U}) {
      edges.push_back({i, (i + step) % kRound});
      edges.push_back({kRound + i, kRound + (i + step) % kRound});
    }
    edges.push_back({i, kRound + i});
  }
  std::vector<std::size_t> group(2 * kRound, 0);
  std::fill(group.begin() + kRound, group.end(), 1);
  Layout layout = layout_graph(2 * kRound, edges);
  separate_strands(layout, group, edges);
  std::size_t left = 0;  // places where the second map lies on the left of the first one's way
  for (std::size_t i = 0; i < kRound; ++i) {
    const Position& from = layout.positions[(i + kRound - 4) % kRound];
    const Position& to = layout.positions[(i + 4) % kRound];
    const Position& here = layout.positions[i];
    const Position& other = layout.positions[kRound + i];
    if ((to.x - from.x) * (other.y - here.y) > (to.y - from.y) * (other.x - here.x)) ++left;
  }
  // All but a few, where the ring is drawn across itself and has no direction.
  EXPECT_TRUE(left <= kRound / 20 || left >= kRound - kRound / 20) << left << " of " << kRound;
}

}  // namespace
}  // namespace mapweld::drawing
