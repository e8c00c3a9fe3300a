// A store in a temporary data folder, and rows to fill it with.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <random>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/merge/merge_state.h"
#include "schema/engine/data_folder.h"
#include "schema/maps/edge_store.h"
#include "schema/maps/map_store.h"
#include "schema/maps/vertex_store.h"
#include "schema/maps/vocabulary_store.h"

namespace mapweld::test {

// A folder that goes with everything in it.
class TempFolder {
 public:
  TempFolder();
  ~TempFolder();
  TempFolder(const TempFolder&) = delete;
  TempFolder& operator=(const TempFolder&) = delete;
  const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
};

// An open data folder of its own.
class TempStore {
 public:
  explicit TempStore(const StoreOptions& options = {});
  Store& store() { return data_->store(); }
  operator Store&() { return store(); }  // NOLINT(google-explicit-constructor)
  ReadTransaction read() { return store().read(); }
  WriteTransaction write() { return store().write(); }
  const std::filesystem::path& folder() const { return folder_.path(); }
  // Closes and opens it again, as a restart does.
  void reopen();
  void close() { data_.reset(); }

 private:
  TempFolder folder_;
  StoreOptions options_;
  std::unique_ptr<DataFolder> data_;
};

// Raw numbers of std::mt19937_64 are the same with every standard library; its distributions are not.
class Random {
 public:
  explicit Random(std::uint64_t seed) : engine_(seed) {}
  // 0 .. below-1.
  std::uint64_t below(std::uint64_t below) { return engine_() % below; }
  // [0, 1).
  double unit() { return static_cast<double>(engine_() >> 11) * 0x1p-53; }
  bool chance(double p) { return unit() < p; }

 private:
  std::mt19937_64 engine_;
};

// An image of 320x240 with `features` appearances on the grid, sorted, of words below `words`; low words are frequent.
AppearanceVector random_appearances(Random& random, int features, std::uint32_t words, bool with_signatures = false);

std::vector<std::uint8_t> random_bytes(Random& random, std::size_t count);

// A verdict with `inliers` matches between images of so many features; every field set.
Verification random_verification(Random& random, int inliers, int features_a, int features_b);

// A time that tests may say: so many seconds after 2026-01-01.
Timestamp at(std::int64_t seconds);

// What stands in its own committed transaction: a vocabulary of `words` words (its file is not one that quantises), a
// plain map, a vertex with neither edges nor bytes.
VocabularyId add_vocabulary(Store& store, std::string_view name = "words", std::uint32_t words = 1'000);
MapId add_map(Store& store, std::string_view name, VocabularyId vocabulary);
VertexId add_vertex(Store& store, MapId map, VocabularyId vocabulary, std::string_view name,
                    const AppearanceVector& appearances);

// Writes a state as the checkpoint of a running merge; edges[first_new_edge ...] are new since the last one.
void save_state(WriteTransaction& db, JobId job, std::uint64_t epoch, const MergeState& state,
                std::size_t first_new_edge = 0);

// Rows as they would be inserted by the functions above.
NewMap new_map(std::string_view name, VocabularyId vocabulary);
NewImage new_image(std::string_view name, const AppearanceVector& appearances);
VerifierId test_verifier(WriteTransaction& db);

}  // namespace mapweld::test
