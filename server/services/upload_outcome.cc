#include "server/services/upload_outcome.h"

#include <optional>

#include "schema/maps/edge_store.h"

namespace mapweld::server {
namespace {

std::optional<std::string> word_of(Reason reason) {
  if (reason == Reason::kNone) return std::nullopt;
  return std::string(to_string(reason));
}

}  // namespace

contract::Upload inserted(VertexId vertex, const std::string& name, int features, Reason reason) {
  contract::Upload upload;
  upload.outcome = "inserted";
  upload.vertex = to_index(vertex);
  upload.name = name;
  upload.features = features;
  upload.edges.emplace();
  upload.reason = word_of(reason);
  return upload;
}

contract::Upload ignored(VertexId similar_to, int inliers, IgnoredReason reason, const std::string& name,
                         int features) {
  contract::Upload upload;
  upload.outcome = "ignored";
  upload.name = name;
  upload.features = features;
  upload.reason = std::string(to_string(reason));
  upload.similar_to = to_index(similar_to);
  upload.inliers = inliers;
  return upload;
}

UploadOutcome first_outcome(const Reader& db, const ImageRow& image) {
  if (!image.vertex) {
    return {ignored(image.similar_to.value_or(VertexId{}), image.inliers, image.ignored_reason, image.name,
                    image.features)};
  }
  UploadOutcome outcome{inserted(*image.vertex, image.name, image.features, image.reason)};
  for (const EdgeRow& edge : list_own_edges_at(db, image.map, *image.vertex)) {
    if (edge.v != *image.vertex) continue;  // made by a later image
    outcome.upload.edges->push_back({.vertex = to_index(edge.u),
                                     .votes = edge.votes,
                                     .inliers = static_cast<int>(edge.inliers),
                                     .confirmed = edge.confirmed,
                                     .confidence = edge.confidence});
  }
  return outcome;
}

}  // namespace mapweld::server
