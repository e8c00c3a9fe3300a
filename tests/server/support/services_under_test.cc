#include "tests/server/support/services_under_test.h"

#include "client/contract/problem.h"
#include "core/errors.h"
#include "core/geometry/epipolar_verifier.h"
#include "server/events/map_events.h"
#include "server/events/merge_events.h"
#include "server/services/hashing.h"
#include "tests/server/support/test_photos.h"

namespace mapweld::test {

using namespace mapweld::server;

namespace {

MergeJobOptions job_options(MergeListener& listener) {
  MergeJobOptions options;
  options.verifier = make_verifier;
  options.listener = &listener;
  return options;
}

}  // namespace

struct ServicesUnderTest::Running {
  Running(Store& store, const ServicesOptions& options)
      : cache(store, options.cache_bytes),
        opener(store, cache),
        workers(options.workers),
        vocabularies(store),
        merge_events(store, events),
        jobs(store, job_options(merge_events)),
        quality(store),
        merges(store, jobs, opener, quality),
        maps(store, opener, vocabularies, [this](std::int64_t merge) { merges.remove(merge); }),
        masks(store, decoder),
        images(store, cache, vocabularies, workers, decoder, metrics, telling(options.images)),
        localization(store, opener, vocabularies, workers, decoder, metrics),
        backups(store, store.file().parent_path() / "backups"),
        transfer(store, maps, vocabularies, store.file().parent_path()),
        removals(store, cache) {
    if (!vocabularies.set_default_from_store()) vocabularies.add("words", small_vocabulary().serialize());
    jobs.start();
  }

  ImageServiceOptions telling(ImageServiceOptions options) {
    options.stored = [this](const std::string& map, const contract::Upload& upload) {
      tell_image(events, map, upload);
    };
    return options;
  }

  Metrics metrics;
  MapCache cache;
  MapOpener opener;
  WorkerPool workers;
  LocalDecoder decoder;
  VocabularyService vocabularies;
  EventHub events;
  MergeEvents merge_events;
  MergeJobs jobs;
  QualityService quality;
  MergeService merges;
  MapService maps;
  MaskService masks;
  ImageService images;
  LocalizeService localization;
  BackupService backups;
  MapTransfer transfer;
  RemovalService removals;
};

ServicesUnderTest::ServicesUnderTest(const ServicesOptions& options)
    : options_(options), running_(std::make_unique<Running>(store_.store(), options)) {}
ServicesUnderTest::~ServicesUnderTest() = default;

void ServicesUnderTest::restart() {
  running_.reset();
  store_.reopen();
  running_ = std::make_unique<Running>(store_.store(), options_);
}

VocabularyService& ServicesUnderTest::vocabularies() { return running_->vocabularies; }
MapService& ServicesUnderTest::maps() { return running_->maps; }
ImageDecoder& ServicesUnderTest::decoder() { return running_->decoder; }
MaskService& ServicesUnderTest::masks() { return running_->masks; }
ImageService& ServicesUnderTest::images() { return running_->images; }
LocalizeService& ServicesUnderTest::localization() { return running_->localization; }
BackupService& ServicesUnderTest::backups() { return running_->backups; }
MapTransfer& ServicesUnderTest::transfer() { return running_->transfer; }
QualityService& ServicesUnderTest::quality() { return running_->quality; }
RemovalService& ServicesUnderTest::removals() { return running_->removals; }
MergeService& ServicesUnderTest::merges() { return running_->merges; }
MergeJobs& ServicesUnderTest::jobs() { return running_->jobs; }
EventHub& ServicesUnderTest::events() { return running_->events; }
MapCache& ServicesUnderTest::cache() { return running_->cache; }
Metrics& ServicesUnderTest::metrics() { return running_->metrics; }

void ServicesUnderTest::create_map(const std::string& name) {
  contract::CreateMap request;
  request.name = name;
  maps().create(request);
}

UploadOutcome ServicesUnderTest::upload(const std::string& map, const std::string& name, const std::string& bytes) {
  ImageUpload image;
  image.name = name;
  image.bytes = {reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size()};
  return images().upload(map, image, std::nullopt);
}

std::string dump_store(Store& store) {
  const ReadTransaction db = store.read();
  std::string out;
  sqlite::Statement tables =
      db.prepare("SELECT name FROM sqlite_schema WHERE type = 'table' AND name NOT LIKE 'sqlite_%' ORDER BY name");
  while (tables.step()) {
    const std::string table(tables.text(0));
    std::vector<std::string> columns;
    sqlite::Statement info = db.prepare("SELECT name FROM pragma_table_info('" + table + "')");
    while (info.step()) columns.emplace_back(info.text(0));
    std::string list;
    for (const std::string& column : columns) list += (list.empty() ? "quote(" : ", quote(") + column + ")";
    sqlite::Statement rows = db.prepare("SELECT " + list + " FROM " + table + " ORDER BY 1, 2");
    std::string content;
    while (rows.step()) {
      for (int i = 0; i < static_cast<int>(columns.size()); ++i) content.append(rows.text(i)).append("|");
      content += "\n";
    }
    const auto hash = sha256({reinterpret_cast<const std::uint8_t*>(content.data()), content.size()});
    out += table + " " + std::to_string(std::count(content.begin(), content.end(), '\n')) + " " + to_hex(hash) + "\n";
  }
  return out;
}

std::string code_of(const std::function<void()>& call) {
  try {
    call();
    return "none";
  } catch (const contract::ContractError& error) {
    return std::string(error.code().word());
  } catch (const ImageError& error) {
    return error.code();
  } catch (const MergeJobError& error) {
    return error.code();
  }
}

}  // namespace mapweld::test
