// The upload of one or more images into one map, from bytes to durable outcomes.
#pragma once

#include <atomic>
#include <chrono>
#include <exception>
#include <functional>
#include <future>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include <opencv2/core/mat.hpp>

#include "core/geometry/pair_verifier.h"
#include "core/mapping/mapper.h"
#include "core/vocabulary/vocabulary.h"
#include "schema/maps/map_store.h"
#include "schema/store.h"
#include "server/maps/loaded_map.h"
#include "server/maps/map_cache.h"
#include "server/maps/map_settings.h"
#include "server/metrics/metrics.h"
#include "server/services/image_analyzer.h"
#include "server/services/keep.h"
#include "server/services/quotas.h"
#include "server/services/upload_outcome.h"
#include "server/services/vocabulary_service.h"
#include "server/services/worker_pool.h"

namespace mapweld::server {

// What uploads work with.
struct UploadContext {
  Store& store;
  MapCache& cache;
  VocabularyService& vocabularies;
  WorkerPool& workers;
  ImageDecoder& decoder;
  Metrics& metrics;
  int max_group = 16;  // images of a batch that are stored in one transaction
  // Told of each image once it is stored; may be empty.
  std::function<void(const std::string& map, const contract::Upload&)> stored = {};

  QuotaTurns quota_turns = {};

  // Images that are not being stored at this time are refused from then on.
  std::atomic<std::chrono::steady_clock::duration> deadline{std::chrono::steady_clock::duration::max()};
  // Throws ContractError shutting_down when that time has come.
  void refuse_when_stopping() const;
};

// Images are analysed on the workers, in parallel; localizing and storing them is serial, in their order, under the
// map's writer turn. Images that are ready together share a transaction: each is localized among those before it in
// memory, and what was added there is taken back when storing fails. Used once, by one thread.
class UploadSession {
 public:
  // Throws ContractError no_such_map, map_is_merged, wrong_map.
  UploadSession(UploadContext& context, const std::string& map_name, const std::optional<std::string>& map_uuid,
                const Keep<StoredUpload>& keep = {}, const Caller* caller = nullptr);

  // An outcome for each, in order; returns when they are durable.
  std::vector<BatchOutcome> run(const std::vector<ImageUpload>& images);

 private:
  struct Prepared {
    Sha256 hash{};
    std::optional<UploadOutcome> repeated;  // the image is stored already
    AnalyzedImage image;  // otherwise; without a vector when the map has these bytes under another name
  };

  struct Pending {
    const ImageUpload* upload = nullptr;
    std::size_t place = 0;  // among all that are uploaded
    Prepared prepared;
    BatchOutcome* outcome = nullptr;
    // Set by decide_all().
    std::string name;
    MappingDecision decision;
    IgnoredReason ignored_reason = IgnoredReason::kTooSimilar;
    VertexId vertex{};
    double decided_in_s = 0;
    const Pending* same_as = nullptr;  // an earlier image of the group with this name and these bytes
    bool settled = false;              // the outcome is known without storing anything
  };
  using NamesOfGroup = std::map<std::string, const Pending*>;
  using ContentsOfGroup = std::map<Sha256, const Pending*>;  // the first image of the group with these bytes

  void open_map();
  int max_group() const;
  Prepared prepare(const ImageUpload& upload) const;  // on a worker
  AnalyzedImage analyzed(const ImageUpload& upload) const;
  std::optional<Pending> receive(const ImageUpload& upload, std::future<Prepared>& future, BatchOutcome& outcome) const;
  std::optional<UploadOutcome> find_repeated(const Reader& db, const std::string& name, const Sha256& hash) const;

  // Localizes and stores a group in order. When that fails, nothing of the group is stored, the failure is the outcome
  // of each, and it is returned.
  std::exception_ptr store(std::vector<Pending>& group);
  void decide_all(std::vector<Pending>& group);
  bool settle_by_name(const Reader& db, Pending& pending, const NamesOfGroup& names) const;
  std::string free_name(const Reader& db, const NamesOfGroup& names, const std::string& wanted) const;
  std::span<const std::uint8_t> bytes_kept(const Pending& pending) const;
  bool refuse_without_room(Pending& pending, Room& room) const;
  bool decide_by_content(const Reader& db, Pending& pending, const ContentsOfGroup& contents) const;
  void decide_one(Pending& pending, std::uint32_t vertices);
  void write_all(std::vector<Pending>& group);
  void keep_all(WriteTransaction& db, std::vector<Pending>& group, double written_s) const;
  static void finish_repeats(std::vector<Pending>& group);
  void write_one(WriteTransaction& db, Pending& pending, VerifierId verifier) const;
  std::string verifier_parameters() const;
  [[noreturn]] void throw_deleted() const;

  UploadContext& context_;
  const Keep<StoredUpload> keep_;
  const Caller* const caller_;  // whose the images become; null: nobody's
  MapRow map_;
  MapSettings settings_;
  cv::Mat mask_;  // empty: none
  std::shared_ptr<const Vocabulary> vocabulary_;
  std::shared_ptr<const PairVerifier> verifier_;
  std::shared_ptr<LoadedMap> loaded_;  // null: too large for memory
};

}  // namespace mapweld::server
