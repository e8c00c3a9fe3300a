#include "server/services/describe.h"

#include "server/services/cameras.h"
#include "server/services/hashing.h"
#include "server/services/times.h"

namespace mapweld::server {
namespace {

std::optional<std::string> describe_time(const std::optional<Timestamp>& time) {
  if (!time) return std::nullopt;
  return to_rfc3339(*time);
}

}  // namespace

contract::Vertex describe_vertex(const VertexRow& row, const std::string& map, std::int64_t degree) {
  const ImageRow& image = row.image;
  contract::Vertex vertex;
  vertex.vertex = to_index(row.vertex);
  vertex.name = image.name;
  vertex.width_px = image.width_px;
  vertex.height_px = image.height_px;
  vertex.features = image.features;
  vertex.degree = degree;
  vertex.captured_at = describe_time(image.provenance.captured_at);
  vertex.sequence = image.provenance.sequence;
  vertex.index = image.provenance.index;
  vertex.sha256 = to_hex(image.sha256);
  vertex.camera = camera_of_row(image.provenance.camera);
  vertex.pose = pose_of_row(image.provenance.pose);
  vertex.map = map;
  vertex.member_vertex = to_index(image.vertex.value_or(row.vertex));
  return vertex;
}

contract::IgnoredImage describe_ignored(const ImageRow& row) {
  contract::IgnoredImage image;
  image.name = row.name;
  image.reason = to_string(row.ignored_reason);
  image.similar_to = to_index(row.similar_to.value_or(VertexId{}));
  image.inliers = row.inliers;
  image.features = row.features;
  image.captured_at = describe_time(row.provenance.captured_at);
  image.sequence = row.provenance.sequence;
  image.index = row.provenance.index;
  image.sha256 = to_hex(row.sha256);
  image.camera = camera_of_row(row.provenance.camera);
  image.pose = pose_of_row(row.provenance.pose);
  return image;
}

contract::Edge describe_edge(const EdgeRow& row) {
  contract::Edge edge;
  edge.u = to_index(row.u);
  edge.v = to_index(row.v);
  edge.kind = row.inter ? "inter" : "inner";
  edge.votes = row.votes;
  edge.inliers = static_cast<int>(row.inliers);
  edge.log10_false_alarms = row.log10_false_alarms;
  edge.confirmed = row.confirmed;
  edge.confidence = row.confidence;
  if (!row.confirmed) edge.reason = row.doubt;
  if (row.job) edge.merge = to_index(*row.job);
  return edge;
}

}  // namespace mapweld::server
