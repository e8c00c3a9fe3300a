// The services over a store of their own, without sockets.
#pragma once

#include <memory>
#include <string>

#include "server/copies/backup_service.h"
#include "server/copies/map_transfer.h"
#include "server/events/event_hub.h"
#include "server/jobs/merge_jobs.h"
#include "server/maps/map_cache.h"
#include "server/maps/map_opener.h"
#include "server/metrics/metrics.h"
#include "server/services/image_service.h"
#include "server/services/localize_service.h"
#include "server/services/map_service.h"
#include "server/services/mask_service.h"
#include "server/services/merge_service.h"
#include "server/services/quality_service.h"
#include "server/services/removal_service.h"
#include "server/services/vocabulary_service.h"
#include "server/services/worker_pool.h"
#include "tests/support/temp_store.h"

namespace mapweld::test {

struct ServicesOptions {
  int workers = 2;
  std::size_t cache_bytes = 256 << 20;
  server::ImageServiceOptions images;
};

// Has the vocabulary "words" (small_vocabulary), which is the default.
class ServicesUnderTest {
 public:
  explicit ServicesUnderTest(const ServicesOptions& options = {});
  ~ServicesUnderTest();

  // Closes the store and opens it again with fresh services, as a restart does.
  void restart();

  Store& store() { return store_; }
  server::VocabularyService& vocabularies();
  server::MapService& maps();
  server::MaskService& masks();
  server::ImageService& images();
  server::LocalizeService& localization();
  server::QualityService& quality();
  server::BackupService& backups();
  server::MapTransfer& transfer();
  server::RemovalService& removals();
  server::MergeService& merges();
  server::MergeJobs& jobs();
  server::EventHub& events();
  server::MapCache& cache();
  server::ImageDecoder& decoder();
  server::Metrics& metrics();

  // A map with default parameters.
  void create_map(const std::string& name);
  // Uploads one image; throws what the service throws.
  server::UploadOutcome upload(const std::string& map, const std::string& name, const std::string& bytes);

 private:
  struct Running;
  ServicesOptions options_;
  TempStore store_;
  std::unique_ptr<Running> running_;
};

// Everything that is stored, as one string a table: two dumps are equal when nothing that counts was changed.
std::string dump_store(Store& store);

// The code of the ContractError, ImageError or MergeJobError that `call` throws; "none" when it throws nothing.
std::string code_of(const std::function<void()>& call);

}  // namespace mapweld::test
