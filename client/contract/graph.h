// The graph of a map and how good it is.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "client/contract/codec.h"
#include "client/contract/edge_counts.h"
#include "client/contract/image.h"

namespace mapweld::contract {

// GET /v1/maps/{m}/edges. Undirected, u < v.
struct Edge {
  std::int64_t u = 0;
  std::int64_t v = 0;
  std::string kind = "inner";  // "inner": within one member; "inter": made by a merge
  std::int64_t votes = 0;
  int inliers = 0;
  double log10_false_alarms = 0;
  bool confirmed = true;              // one of the map's edges; otherwise only verified
  std::optional<double> confidence;   // 0 to 1; null: nobody has judged it, and it is confirmed
  std::optional<std::string> reason;  // why it is not confirmed
  std::optional<std::int64_t> merge;  // the merge that made an inter edge
  static constexpr auto fields() {
    return std::tuple(field("u", &Edge::u), field("v", &Edge::v), field("kind", &Edge::kind),
                      field("votes", &Edge::votes), field("inliers", &Edge::inliers),
                      field("log10_false_alarms", &Edge::log10_false_alarms), field("confirmed", &Edge::confirmed),
                      field("confidence", &Edge::confidence), omitted_when_empty("reason", &Edge::reason),
                      field("merge", &Edge::merge));
  }
  friend bool operator==(const Edge&, const Edge&) = default;
};

// GET /v1/maps/{m}/graph?format=json
struct Graph {
  std::vector<Vertex> vertices;
  std::vector<Edge> edges;
  static constexpr auto fields() {
    return std::tuple(field("vertices", &Graph::vertices), field("edges", &Graph::edges));
  }
  friend bool operator==(const Graph&, const Graph&) = default;
};

struct LargestComponent {
  std::int64_t vertices = 0;
  double algebraic_connectivity = 0;
  static constexpr auto fields() {
    using L = LargestComponent;
    return std::tuple(field("vertices", &L::vertices), field("algebraic_connectivity", &L::algebraic_connectivity));
  }
  friend bool operator==(const LargestComponent&, const LargestComponent&) = default;
};

// How many vertices of a member have an inter-map edge.
struct Joined {
  std::string map;
  std::int64_t vertices = 0;
  static constexpr auto fields() {
    return std::tuple(field("map", &Joined::map), field("vertices", &Joined::vertices));
  }
  friend bool operator==(const Joined&, const Joined&) = default;
};

// GET /v1/maps/{m}/quality. Of the confirmed edges. `joined` is empty and `independent_joins` 0 for a plain map.
struct Quality {
  std::int64_t vertices = 0;
  std::int64_t edges = 0;  // confirmed ones
  EdgeCounts edge_counts;
  std::int64_t components = 0;
  double algebraic_connectivity = 0;           // of the whole graph: exactly 0 when it is not connected
  double weighted_algebraic_connectivity = 0;  // the same with inliers as weights
  LargestComponent largest_component;
  std::int64_t min_degree = 0;
  std::int64_t edge_connectivity = 0;
  std::vector<Joined> joined;
  std::int64_t independent_joins = 0;  // maximum matching of the inter-map edges
  static constexpr auto fields() {
    using Q = Quality;
    return std::tuple(field("vertices", &Q::vertices), field("edges", &Q::edges), field("edge_counts", &Q::edge_counts),
                      field("components", &Q::components), field("algebraic_connectivity", &Q::algebraic_connectivity),
                      field("weighted_algebraic_connectivity", &Q::weighted_algebraic_connectivity),
                      field("largest_component", &Q::largest_component), field("min_degree", &Q::min_degree),
                      field("edge_connectivity", &Q::edge_connectivity), field("joined", &Q::joined),
                      field("independent_joins", &Q::independent_joins));
  }
  friend bool operator==(const Quality&, const Quality&) = default;
};

}  // namespace mapweld::contract
