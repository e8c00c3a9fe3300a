// "Where am I?" as a use case (paper, section III-A).
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>

#include "client/contract/image.h"
#include "schema/store.h"
#include "server/decoding/image_decoder.h"
#include "server/maps/map_opener.h"
#include "server/metrics/metrics.h"
#include "server/services/vocabulary_service.h"
#include "server/services/worker_pool.h"

namespace mapweld::server {

struct LocalizeQuery {
  std::span<const std::uint8_t> image;
  std::size_t limit = 5;       // matches in the answer
  bool verified_only = false;  // leave out candidates that were not verified or did not pass
  // Which camera took the image: none, nobody knows; or the map's own.
  std::optional<contract::Camera> camera = {};
  bool by_camera_of_map = false;
};

// Thread-safe; changes nothing.
class LocalizeService {
 public:
  // Everything given must outlive this.
  LocalizeService(Store& store, MapOpener& opener, VocabularyService& vocabularies, WorkerPool& workers,
                  ImageDecoder& decoder, Metrics& metrics)
      : store_(store),
        opener_(opener),
        vocabularies_(vocabularies),
        workers_(workers),
        decoder_(decoder),
        metrics_(metrics) {}

  // In a plain or merged map; in the latter also while its merge runs. A plain map's mask is laid over the query.
  // With a camera, verified matches tell how it stands to theirs.
  // Throws ContractError no_such_map, empty_body, invalid_parameter (the map has no camera); ImageError; StoreError.
  contract::Localization localize(const std::string& map, const LocalizeQuery& query);

 private:
  Store& store_;
  MapOpener& opener_;
  VocabularyService& vocabularies_;
  WorkerPool& workers_;
  ImageDecoder& decoder_;
  Metrics& metrics_;
};

}  // namespace mapweld::server
