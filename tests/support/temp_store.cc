#include "tests/support/temp_store.h"

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <optional>
#include <stdexcept>

#include <openssl/sha.h>
#include <unistd.h>

#include "core/vocabulary/appearance_vector.h"
#include "schema/blobs/merge_state_blob.h"
#include "schema/merges/merge_store.h"
#include "tests/core/retrieval/random_images.h"

namespace mapweld::test {

namespace {

// In memory where there is room for it: most tests wait for nothing but the disk otherwise. TMPDIR chooses.
std::filesystem::path folder_for_tests() {
  const std::filesystem::path memory = "/dev/shm";
  std::error_code error;
  constexpr std::uintmax_t kEnough = std::uintmax_t{1} << 30;
  if (std::getenv("TMPDIR") == nullptr) {
    const auto space = std::filesystem::space(memory, error);
    if (!error && space.available >= kEnough && ::access(memory.c_str(), W_OK) == 0) return memory;
  }
  return std::filesystem::temp_directory_path();
}

}  // namespace

TempFolder::TempFolder() {
  std::string name = (folder_for_tests() / "mapweld-test-XXXXXX").string();
  if (::mkdtemp(name.data()) == nullptr) throw std::runtime_error("cannot create a temporary folder");
  path_ = name;
}

TempFolder::~TempFolder() {
  std::error_code ignored;
  std::filesystem::remove_all(path_, ignored);
}

TempStore::TempStore(const StoreOptions& options) : options_(options) { reopen(); }

void TempStore::reopen() {
  data_.reset();
  DataFolderOptions options;
  options.store = options_;
  data_ = std::make_unique<DataFolder>(folder_.path() / "data", options);
}

AppearanceVector random_appearances(Random& random, int features, std::uint32_t words, bool with_signatures) {
  AppearanceVector image{320, 240, {}};
  const auto draw = [&random] { return random.below(1U << 30); };
  for (int i = 0; i < features; ++i) {
    const double u = random.unit();
    const auto word = static_cast<std::uint32_t>(u * u * words);
    const Keypoint keypoint{static_cast<float>(random.unit() * 320), static_cast<float>(random.unit() * 240),
                            static_cast<float>(1.5 + random.unit() * 60), static_cast<float>(random.unit() * 360)};
    image.appearances.push_back(snap_to_grid(WordId{word}, keypoint));
    if (with_signatures) image.appearances.back().signature = signature_for(WordId{word}, draw);
  }
  std::ranges::sort(image.appearances);
  return image;
}

std::vector<std::uint8_t> random_bytes(Random& random, std::size_t count) {
  std::vector<std::uint8_t> bytes(count);
  for (std::uint8_t& byte : bytes) byte = static_cast<std::uint8_t>(random.below(256));
  return bytes;
}

Verification random_verification(Random& random, int inliers, int features_a, int features_b) {
  Verification verdict;
  verdict.accepted = true;
  verdict.matches = inliers + static_cast<int>(random.below(50));
  verdict.inliers = inliers;
  verdict.log10_false_alarms = -100 * random.unit();
  verdict.kind = random.chance(0.5) ? GeometryKind::kFundamental : GeometryKind::kHomography;
  for (double& value : verdict.geometry) value = random.unit() - 0.5;
  for (int i = 0; i < inliers; ++i) {
    verdict.inlier_matches.emplace_back(random.below(static_cast<std::uint64_t>(features_a)),
                                        random.below(static_cast<std::uint64_t>(features_b)));
  }
  std::ranges::sort(verdict.inlier_matches);
  return verdict;
}

Timestamp at(std::int64_t seconds) {
  using namespace std::chrono;
  return Timestamp{sys_days{year{2026} / January / 1} + std::chrono::seconds{seconds}};
}

NewMap new_map(std::string_view name, VocabularyId vocabulary) {
  static int count = 0;
  char uuid[37];
  std::snprintf(uuid, sizeof uuid, "00000000-0000-4000-8000-%012x", static_cast<unsigned>(++count));
  return {std::string(name), uuid, vocabulary, R"({"min_votes":12})", R"({"robot":"p3at-1"})", at(1)};
}

NewImage new_image(std::string_view name, const AppearanceVector& appearances) {
  NewImage image;
  image.name = name;
  image.media_type = "image/jpeg";
  image.width_px = appearances.width_px;
  image.height_px = appearances.height_px;
  image.features = static_cast<int>(appearances.appearances.size());
  image.uploaded_at = at(2);
  return image;
}

void save_state(WriteTransaction& db, JobId job, std::uint64_t epoch, const MergeState& state,
                std::size_t first_new_edge) {
  const std::vector<blobs::MergeStatePart> encoded = blobs::encode_merge_state(state, std::nullopt);
  std::vector<CheckpointPart> parts;
  for (const blobs::MergeStatePart& part : encoded) parts.push_back({part.name, part.bytes});
  std::vector<NewEdge> edges;
  for (std::size_t i = first_new_edge; i < state.edges.size(); ++i) {
    const MergeEdge& e = state.edges[i];
    edges.push_back(
        {.u = e.u, .v = e.v, .votes = e.votes, .verification = e.verification, .verifications = e.verifications});
  }
  CheckpointWrite checkpoint;
  checkpoint.step = state.step;
  checkpoint.phase = to_string(state.phase);
  checkpoint.spent = {1.5, state.verifications, state.edges.size()};
  checkpoint.parts = parts;
  checkpoint.edges = edges;
  checkpoint.verifier = test_verifier(db);
  checkpoint.now = at(3);
  save_checkpoint(db, job, epoch, checkpoint);
}

VerifierId test_verifier(WriteTransaction& db) { return intern_verifier(db, "test-1", R"({"min_inliers":12})"); }

VocabularyId add_vocabulary(Store& store, std::string_view name, std::uint32_t words) {
  Random random(words);
  const auto file = random_bytes(random, 4'000);
  NewVocabulary vocabulary;
  vocabulary.name = name;
  vocabulary.words = words;
  vocabulary.engine = "hnsw";
  SHA256(file.data(), file.size(), vocabulary.sha256.data());
  vocabulary.created_at = at(0);
  WriteTransaction db = store.write();
  const VocabularyId id = insert_vocabulary(db, vocabulary, file);
  db.commit();
  return id;
}

MapId add_map(Store& store, std::string_view name, VocabularyId vocabulary) {
  WriteTransaction db = store.write();
  const MapId map = insert_map(db, new_map(name, vocabulary));
  db.commit();
  return map;
}

VertexId add_vertex(Store& store, MapId map, VocabularyId vocabulary, std::string_view name,
                    const AppearanceVector& appearances) {
  WriteTransaction db = store.write();
  const VertexId vertex =
      insert_vertex(db, map, vocabulary, new_image(name, appearances), appearances, {}, test_verifier(db));
  db.commit();
  return vertex;
}

}  // namespace mapweld::test
