// Routes through a map.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "client/contract/graph.h"

namespace mapweld::contract {

// GET /v1/maps/{m}/route. The widest path: the one whose weakest edge is strongest; the shortest among those.
struct Route {
  std::vector<std::int64_t> vertices;       // from .. to, both included
  std::vector<Edge> edges;                  // one fewer; in the order of travel
  std::optional<std::int64_t> min_inliers;  // of the weakest edge; null for a route of one vertex
  static constexpr auto fields() {
    return std::tuple(field("vertices", &Route::vertices), field("edges", &Route::edges),
                      field("min_inliers", &Route::min_inliers));
  }
  friend bool operator==(const Route&, const Route&) = default;
};

}  // namespace mapweld::contract
