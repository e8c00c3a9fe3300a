#include "client/drawing/curve_csv.h"

#include "client/contract/json.h"

namespace mapweld::drawing {

std::string curve_csv(std::span<const contract::CurvePoint> points) {
  std::string csv =
      "step,elapsed_s,verifications,edges,components,algebraic_connectivity,largest_component_vertices,"
      "largest_component_algebraic_connectivity,certified_fraction,phase,confirmed_edges\n";
  const auto number = [](auto value) { return contract::Json(value).dump(); };
  for (const contract::CurvePoint& point : points) {
    csv += number(point.step) + "," + number(point.elapsed_s) + "," + number(point.verifications) + "," +
           number(point.edges) + "," + number(point.components) + "," + number(point.algebraic_connectivity) + "," +
           number(point.largest_component.vertices) + "," + number(point.largest_component.algebraic_connectivity) +
           "," + (point.certified_fraction ? number(*point.certified_fraction) : "") + "," + point.phase + "," +
           (point.edge_counts ? number(point.edge_counts->confirmed) : "") + "\n";
  }
  return csv;
}

}  // namespace mapweld::drawing
