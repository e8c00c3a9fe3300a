#include "server/services/localize_service.h"

#include <optional>
#include <stdexcept>
#include <vector>

#include "client/contract/problem.h"
#include "core/geometry/epipolar_verifier.h"
#include "core/mapping/localizer.h"
#include "core/mapping/static_content.h"
#include "schema/maps/map_layout.h"
#include "schema/maps/mask_store.h"
#include "schema/maps/vertex_store.h"
#include "server/maps/map_settings.h"
#include "server/services/cameras.h"
#include "server/services/image_analyzer.h"
#include "server/services/map_lookup.h"
#include "server/services/mask_service.h"
#include "server/services/timed_verifier.h"

namespace mapweld::server {
namespace {

using contract::ContractError;

contract::Funnel describe(const Localization::Funnel& funnel) {
  return {.features = funnel.features,
          .known_words = funnel.known_words,
          .candidates = funnel.candidates,
          .verified = funnel.verified,
          .best_inliers = funnel.best_inliers,
          .needed_inliers = funnel.needed_inliers};
}

}  // namespace

contract::Localization LocalizeService::localize(const std::string& map_name, const LocalizeQuery& query) {
  if (query.image.empty()) throw ContractError("empty_body", "The image has no bytes.");
  MapRow map;
  std::optional<std::vector<std::uint8_t>> mask_png;
  std::optional<contract::Camera> camera = query.camera;
  {
    const ReadTransaction db = store_.read();
    map = require_map(db, map_name);
    if (query.by_camera_of_map && !(camera = camera_of_map(db, map.id))) {
      throw ContractError("invalid_parameter",
                          "The map \"" + map_name + "\" has no camera of its own; name the query's.");
    }
    mask_png = load_mask_bytes(db, map.id);
  }
  const cv::Mat mask = mask_in(mask_png, decoder_);
  const MapParameters parameters = settings_of(map).parameters;
  const std::shared_ptr<const Vocabulary> vocabulary = vocabularies_.load(map.vocabulary);
  AnalyzedImage image;
  {
    WorkerPool::Lane lane(workers_);
    image = lane.submit([&] {
                  return analyze(query.image, *vocabulary, parameters.max_features, mask, decoder_, metrics_);
                })
                .get();
  }

  const Stopwatch watch;
  const ReadTransaction db = store_.read();
  contract::Localization answer;
  try {
    map = require_map(db, map_name);
    const MapLayout layout = load_layout(db, map.id);
    const std::unique_ptr<MapSnapshot> view = opener_.open(db, layout);
    const auto verifier = make_verifier({.min_inliers = parameters.min_inliers});
    const TimedVerifier timed(*verifier);
    const Stopwatch search;
    const AppearanceVector seen = with_known_static(*image.vector, *view);
    const Localization found = mapweld::localize(seen, *view, timed, parameters);
    metrics_.stage(Stage::kVerify).record(timed.elapsed_s());
    metrics_.stage(Stage::kVote).record(search.elapsed_s() - timed.elapsed_s());

    answer.status = to_string(found.status);
    if (found.reason != Reason::kNone) answer.reason = std::string(to_string(found.reason));
    answer.funnel = describe(found.funnel);
    MapNames names(db);
    for (const LocalizationMatch& match : found.matches) {
      if (answer.matches.size() == query.limit || (query.verified_only && !match.verified)) break;
      const LeafVertex leaf = layout.leaf(match.vertex);
      const std::optional<ImageRow> row = find_vertex(db, leaf.map, leaf.vertex);
      if (!row) continue;  // deleted meanwhile
      answer.matches.push_back({.vertex = to_index(match.vertex),
                                .map = names(leaf.map),
                                .member_vertex = to_index(leaf.vertex),
                                .name = row->name,
                                .votes = match.votes,
                                .inliers = match.verification.inliers,
                                .verified = match.verified,
                                .pose = pose_of_row(row->provenance.pose),
                                .relative = {}});
      if (!camera || !match.verified) continue;
      answer.matches.back().relative = relative_between(seen, camera, *view->appearances(match.vertex),
                                                        camera_of_image(db, *row), match.verification);
    }
  } catch (const std::out_of_range&) {  // deleted meanwhile, or a member of it
    throw ContractError("no_such_map", "The map \"" + map_name + "\" was deleted.");
  }
  answer.took_ms = shown_ms(image.took_s + watch.elapsed_s());
  return answer;
}

}  // namespace mapweld::server
