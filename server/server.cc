#include "server/server.h"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <filesystem>
#include <optional>
#include <stdexcept>
#include <thread>
#include <utility>
#include <vector>

#include <spdlog/spdlog.h>

#include "core/feature/allocation.h"
#include "core/geometry/epipolar_verifier.h"
#include "schema/engine/data_folder.h"
#include "schema/maps/map_store.h"
#include "schema/ownership_store.h"
#include "server/access/access_gate.h"
#include "server/access/addresses.h"
#include "server/access/key_ring.h"
#include "server/api/api.h"
#include "server/copies/backup_service.h"
#include "server/copies/map_transfer.h"
#include "server/copies/transit_folder.h"
#include "server/decoding/decoder_pool.h"
#include "server/events/event_hub.h"
#include "server/events/map_events.h"
#include "server/events/merge_events.h"
#include "server/events/merge_journal.h"
#include "server/jobs/merge_jobs.h"
#include "server/judge_worker.h"
#include "server/maps/map_cache.h"
#include "server/maps/map_opener.h"
#include "server/metrics/metrics.h"
#include "server/segment_writer.h"
#include "server/services/worker_pool.h"

namespace mapweld::server {
namespace {

int cores() { return static_cast<int>(std::max(1u, std::thread::hardware_concurrency())); }

int extract_threads(const ServerConfig& config) {
  return config.extract_threads > 0 ? config.extract_threads : cores();
}

MergeJobOptions job_options(const ServerConfig& config, MergeListener& listener) {
  MergeJobOptions options;
  options.verifier = make_verifier;
  options.listener = &listener;
  options.checkpoint_interval_s = config.checkpoint_interval_s;
  options.workers = config.merge_workers;
  options.verify_threads = config.verify_threads > 0 ? config.verify_threads : cores();
  options.log = [](const std::string& line) { spdlog::warn("{}", line); };
  return options;
}

std::unique_ptr<DecoderPool> make_decoders(const ServerConfig& config) {
  if (config.decoders == 0) return nullptr;
  return std::make_unique<DecoderPool>(
      DecoderPoolOptions{.processes = config.decoders > 0 ? config.decoders : extract_threads(config),
                         .max_file_bytes = config.http.max_body_bytes});
}

DataFolderOptions folder_options(const ServerConfig& config) {
  DataFolderOptions options;
  if (config.read_only) options.access = DataFolderOptions::Access::kServeReadOnly;
  return options;
}

AccessOptions access_options(const ServerConfig& config) {
  AccessOptions options = config.access;
  options.read_only = config.read_only;
  return options;
}

HttpOptions http_options(const ServerConfig& config, const TransitFolder& transit) {
  HttpOptions options = config.http;
  options.body_folder = transit.path();
  return options;
}

// How long after stop() the images of requests under way are still stored.
constexpr std::chrono::seconds kUploadGrace{3};

}  // namespace

class Server::Impl {
 public:
  explicit Impl(const ServerConfig& config)
      : read_only_(config.read_only),
        folder_(config.data, folder_options(config)),
        store_(folder_.store()),
        transit_(config.data, config.read_only),
        cache_(store_, config.cache_mb * 1024 * 1024),
        opener_(store_, cache_),
        decoders_(make_decoders(config)),
        workers_(extract_threads(config), give_back_freed_memory),
        vocabularies_(store_),
        merge_events_(store_, events_),
        journal_(store_, merge_events_, config.log_format),
        jobs_(store_, job_options(config, journal_)),
        quality_(store_),
        merges_(store_, jobs_, opener_, quality_),
        maps_(store_, opener_, vocabularies_, [this](std::int64_t merge) { merges_.remove(merge); }),
        masks_(store_, decoder()),
        images_(store_, cache_, vocabularies_, workers_, decoder(), metrics_,
                {.stored = [this](const std::string& map,
                                  const contract::Upload& upload) { tell_image(events_, map, upload); }}),
        localization_(store_, opener_, vocabularies_, workers_, decoder(), metrics_),
        backups_(store_, config.data / "backups"),
        transfer_(store_, maps_, vocabularies_, transit_.path()),
        removals_(store_, cache_),
        idempotency_(store_),
        keys_(config.data, config.read_only),
        gate_(keys_, access_options(config), config.log_format),
        http_(http_options(config, transit_), routes(), metrics_, &gate_) {
    refuse_open_door(config);
    choose_vocabulary(config);
    add_gauges();
    port_ = http_.bind();
    if (read_only_) return;
    segments_.emplace(store_);
    judges_.emplace(store_, cache_, config.cache_mb << 20);
    jobs_.start();
  }

  int port() const { return port_; }

  void run() {
    // Merges are checkpointed while the last requests are answered.
    std::thread jobs_stopper([this] {
      stopping_.wait(false);
      jobs_.shutdown();
    });
    http_.serve();
    stop();
    jobs_stopper.join();
    if (segments_) segments_->stop();
    if (judges_) judges_->stop();
  }

  void reload_certificate() { http_.reload_certificate(); }

  void stop() {
    if (stopping_.exchange(true)) return;
    stopping_.notify_all();
    images_.refuse_after(std::chrono::steady_clock::now() + kUploadGrace);
    http_.drain();
  }

 private:
  Router routes() {
    return make_router({.store = store_,
                        .metrics = metrics_,
                        .vocabularies = vocabularies_,
                        .maps = maps_,
                        .masks = masks_,
                        .images = images_,
                        .localization = localization_,
                        .quality = quality_,
                        .removals = removals_,
                        .merges = merges_,
                        .decoder = decoder(),
                        .events = events_,
                        .backups = backups_,
                        .transfer = transfer_,
                        .idempotency = idempotency_,
                        .ready = [this] { return !stopping_ && store_.in_place() && has_vocabulary(); }});
  }

  ImageDecoder& decoder() { return decoders_ ? static_cast<ImageDecoder&>(*decoders_) : local_decoder_; }

  void refuse_open_door(const ServerConfig& config) {
    if (config.insecure || keys_.find("").has_keys || is_loopback(config.http.host)) return;
    throw std::runtime_error("whoever reaches " + config.http.host +
                             " could do everything: there are no keys. Make one first (mapweld-server key create NAME "
                             "--role admin --data " +
                             config.data.string() + "), listen on 127.0.0.1, or let everybody in with --insecure");
  }

  bool has_vocabulary() const {
    try {
      vocabularies_.resolve(store_.read(), std::nullopt);
      return true;
    } catch (const contract::ContractError&) {
      return false;
    }
  }

  void choose_vocabulary(const ServerConfig& config) {
    if (read_only_) {
      vocabularies_.set_default_from_store();
    } else if (config.vocabulary) {
      vocabularies_.set_default(*config.vocabulary);
    } else if (!vocabularies_.set_default_from_store()) {
      if (const auto shipped = find_shipped_vocabulary()) {
        vocabularies_.set_default(*shipped);
      } else {
        spdlog::warn("there is no vocabulary yet: train one and upload it, or give --vocabulary");
      }
    }
  }

  void add_gauges() {
    metrics_.add_gauge("maps_in_memory", "Plain maps kept in memory.",
                       [this] { return static_cast<double>(cache_.statistics().maps); });
    metrics_.add_gauge("maps_in_memory_bytes", "What they occupy, about.",
                       [this] { return static_cast<double>(cache_.statistics().bytes); });
    metrics_.add_gauge("store_commits", "Transactions committed since the start.",
                       [this] { return static_cast<double>(store_.statistics().commits); });
    metrics_.add_gauge("store_wal_pages", "Pages in the write-ahead log after the last commit.",
                       [this] { return static_cast<double>(store_.statistics().wal_pages); });
    if (decoders_) {
      metrics_.add_gauge("decoders_replaced", "Processes that decoded images and died over one.",
                         [this] { return static_cast<double>(decoders_->replaced()); });
    }
    metrics_.add_gauge("connections", "Open connections, idle ones too.",
                       [this] { return static_cast<double>(http_.connections()); });
    metrics_.add_gauge("event_streams", "Open streams of events.",
                       [this] { return static_cast<double>(events_.streams()); });
    metrics_.add_gauges("key_images", "Images that are each key's.", "key",
                        [this] { return of_each_key([](const KeyUsage& usage) { return usage.images; }); });
    metrics_.add_gauges("key_bytes", "Bytes that are kept of them.", "key",
                        [this] { return of_each_key([](const KeyUsage& usage) { return usage.bytes; }); });
    metrics_.add_gauges("key_queued_merges", "Merges of each key that wait or run.", "key",
                        [this] { return of_each_key([](const KeyUsage& usage) { return usage.queued_merges; }); });
    metrics_.add_gauges("merges", "Merges by state.", "state", [this] { return merges_by_state(); });
    metrics_.add_counter("merge_verifications_total", "Pairs that merges have verified since the start.",
                         [this] { return static_cast<double>(journal_.totals().verifications); });
    metrics_.add_counter("merge_edges_total", "Edges that merges have inserted since the start.",
                         [this] { return static_cast<double>(journal_.totals().edges); });
    metrics_.add_gauge("edges_verified", "Edges of all maps, inner and inter edges, each once.",
                       [this] { return static_cast<double>(edges_verified_and_confirmed().first); });
    metrics_.add_gauge("edges_confirmed", "Of them, those that are edges of their maps.",
                       [this] { return static_cast<double>(edges_verified_and_confirmed().second); });
  }

  Metrics::Labelled of_each_key(std::int64_t (*number)(const KeyUsage& usage)) {
    Metrics::Labelled numbers;
    const ReadTransaction db = store_.read();
    for (const auto& caller : keys_.in_force()) {
      numbers[caller->name] = static_cast<double>(number(usage_of(db, caller->id)));
    }
    return numbers;
  }

  Metrics::Labelled merges_by_state() {
    Metrics::Labelled merges;
    for (const auto& [state, count] : count_merges(store_.read())) {
      merges[std::string(to_string(state))] = static_cast<double>(count);
    }
    return merges;
  }

  std::pair<std::uint64_t, std::uint64_t> edges_verified_and_confirmed() {
    constexpr std::size_t kMapsAtOnce = 1000;
    std::pair<std::uint64_t, std::uint64_t> counts;
    const ReadTransaction db = store_.read();
    std::optional<MapId> last;
    while (true) {
      const std::vector<MapRow> maps = list_maps(db, kMapsAtOnce, last);
      for (const MapRow& map : maps) {
        counts.first += map.edges;
        counts.second += map.edges - map.unconfirmed;
      }
      if (maps.size() < kMapsAtOnce) return counts;
      last = maps.back().id;
    }
  }

  const bool read_only_;
  Metrics metrics_;
  DataFolder folder_;
  Store& store_;
  const TransitFolder transit_;
  MapCache cache_;
  MapOpener opener_;
  const std::unique_ptr<DecoderPool> decoders_;  // null: images are decoded in this process
  LocalDecoder local_decoder_;
  WorkerPool workers_;
  VocabularyService vocabularies_;
  EventHub events_;
  MergeEvents merge_events_;
  MergeJournal journal_;
  MergeJobs jobs_;
  QualityService quality_;
  MergeService merges_;
  MapService maps_;
  MaskService masks_;
  ImageService images_;
  LocalizeService localization_;
  BackupService backups_;
  MapTransfer transfer_;
  RemovalService removals_;
  IdempotencyKeys idempotency_;
  KeyRing keys_;
  AccessGate gate_;
  HttpServer http_;
  std::optional<SegmentWriter> segments_;  // this and the next: none where nothing is changed
  std::optional<JudgeWorker> judges_;
  int port_ = 0;
  std::atomic<bool> stopping_{false};
};

Server::Server(const ServerConfig& config) : impl_(std::make_unique<Impl>(config)) {}
Server::~Server() = default;
int Server::port() const { return impl_->port(); }
void Server::run() { impl_->run(); }
void Server::reload_certificate() { impl_->reload_certificate(); }
void Server::stop() { impl_->stop(); }

}  // namespace mapweld::server
