// Mapping as a use case: uploaded images become vertices and edges of a map, or are ignored (paper, section III-B).
#pragma once

#include <chrono>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "schema/store.h"
#include "server/maps/map_cache.h"
#include "server/metrics/metrics.h"
#include "server/services/upload_outcome.h"
#include "server/services/upload_session.h"
#include "server/services/vocabulary_service.h"
#include "server/services/worker_pool.h"

namespace mapweld::server {

struct ImageServiceOptions {
  int max_group = 16;  // images of a batch that are stored in one transaction
  // Told of each image once it is stored; may be empty. Any thread.
  std::function<void(const std::string& map, const contract::Upload&)> stored = {};
};

// Thread-safe. Uploads into one map take turns; different maps do not wait for each other, and analysing images waits
// for nobody.
class ImageService {
 public:
  // Everything given must outlive this.
  ImageService(Store& store, MapCache& cache, VocabularyService& vocabularies, WorkerPool& workers,
               ImageDecoder& decoder, Metrics& metrics, const ImageServiceOptions& options = {})
      : context_{store, cache, vocabularies, workers, decoder, metrics, options.max_group, options.stored} {}

  // Returns when the outcome is durable. The image is the caller's, if there is one. The same name with the same bytes
  // gets the first outcome again. Throws ContractError no_such_map, map_is_merged, wrong_map (`map_uuid` is another
  // map's), invalid_name, name_taken, empty_body, shutting_down, quota_exceeded; ImageError; StoreError. Then nothing
  // is stored.
  UploadOutcome upload(const std::string& map, const ImageUpload& image, const std::optional<std::string>& map_uuid,
                       const Keep<StoredUpload>& keep = {}, const Caller* caller = nullptr);

  // Takes images in their order: the map becomes the one that single uploads in this order make. Each has its own
  // outcome or problem. When storing fails, the images after it are not tried: they get the same problem.
  // `keep` hears of those that are stored now, in the transaction that stores them.
  // Throws what concerns the batch as a whole (the map), before anything is stored.
  std::vector<BatchOutcome> upload_batch(const std::string& map, const std::vector<ImageUpload>& images,
                                         const std::optional<std::string>& map_uuid,
                                         const Keep<StoredUpload>& keep = {}, const Caller* caller = nullptr);

  // The server is stopping: images that are not being stored at this time are refused with shutting_down.
  void refuse_after(std::chrono::steady_clock::time_point deadline) { context_.deadline = deadline.time_since_epoch(); }

 private:
  UploadContext context_;
};

}  // namespace mapweld::server
