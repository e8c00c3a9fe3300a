#include "client/contract/map.h"

#include "client/contract/checks.h"
#include "client/contract/names.h"

namespace mapweld::contract {
namespace {

void check(const std::optional<MapParameters>& given) {
  if (!given) return;
  const MapParameters& parameters = *given;
  check_range(parameters.max_features, "parameters.max_features", 1, 65535);
  check_range(parameters.min_votes, "parameters.min_votes", 1, 65535);
  check_range(parameters.min_inliers, "parameters.min_inliers", 1, 65535);
  check_range(parameters.max_inliers, "parameters.max_inliers", 1, 65535);
  check_range(parameters.verify_top, "parameters.verify_top", 1, 1000);
  check_one_of(parameters.votes, "parameters.votes", {"min", "product", "signatures"});
  check_one_of(parameters.store_images, "parameters.store_images", {"full", "none"});
  if (parameters.min_inliers && parameters.max_inliers && *parameters.min_inliers > *parameters.max_inliers) {
    throw ContractError("invalid_parameter", "\"parameters.min_inliers\" must not exceed \"parameters.max_inliers\".");
  }
}

void check(const std::optional<std::map<std::string, std::string>>& labels) {
  if (!labels) return;
  if (labels->size() > 64) throw ContractError("invalid_parameter", "\"labels\" has more than 64 entries.");
  for (const auto& [key, text] : *labels) {
    if (key.empty() || key.size() > 255 || text.size() > 4096) {
      throw ContractError("invalid_parameter", "A label's key must be 1 to 255 bytes, its text at most 4096.");
    }
  }
}

}  // namespace

void check(const CreateMap& request) {
  check_slug(request.name, "The map's name");
  if (request.vocabulary) check_slug(*request.vocabulary, "The vocabulary's name");
  if (request.uuid && !is_uuid(*request.uuid)) {
    throw ContractError("invalid_parameter", "\"uuid\" must be a UUID of 8-4-4-4-12 hexadecimal digits.");
  }
  check(request.parameters);
  check(request.labels);
}

void check(const ChangeMap& request) {
  if (request.name) check_slug(*request.name, "The map's name");
  check(request.parameters);
  check(request.labels);
  if (request.camera && *request.camera != Camera{}) check(*request.camera);
}

}  // namespace mapweld::contract
