#include "server/commands/purge.h"

#include <filesystem>
#include <fstream>
#include <iterator>
#include <span>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <openssl/sha.h>

#include "schema/blobs/appearance_blob.h"
#include "schema/maps/vertex_removal.h"
#include "schema/segments/segment_store.h"
#include "schema/store_check.h"
#include "tests/server/commands/run_command.h"
#include "tests/support/temp_store.h"

namespace mapweld::test {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;

Ran purge(const TempStore& store, const std::string& flags = {}) {
  return run_command(server::add_purge_command, "purge --data " + (store.folder() / "data").string() + flags);
}

// Everything that the files of a folder hold.
std::string bytes_in(const fs::path& folder) {
  std::string all;
  for (const auto& file : fs::recursive_directory_iterator(folder)) {
    if (!file.is_regular_file()) continue;
    std::ifstream in(file.path(), std::ios::binary);
    all.append(std::istreambuf_iterator<char>(in), {});
  }
  return all;
}

std::string text_of(std::span<const std::uint8_t> bytes) { return {bytes.begin(), bytes.end()}; }

constexpr std::uint32_t kWords = 1'000;

TEST(PurgeCommand, LeavesNoByteOfWhatWasDeleted) {
  TempStore store;
  const VocabularyId vocabulary = add_vocabulary(store, "words", kWords);
  const MapId map = add_map(store, "lab", vocabulary);
  Random random(3);
  std::vector<std::string> traces;  // of vertex 5
  for (std::uint32_t v = 0; v < 20; ++v) {
    const AppearanceVector image = random_appearances(random, 80, kWords, true);
    WriteTransaction db = store.write();
    NewImage row = new_image(v == 5 ? "a-name-like-no-other" : "image-" + std::to_string(v), image);
    const auto bytes = random_bytes(random, 20'000);
    row.bytes = bytes;
    SHA256(bytes.data(), bytes.size(), row.sha256.data());
    std::vector<NewEdge> edges;
    if (v > 0) edges.push_back({.u = VertexId{v - 1}, .verification = random_verification(random, 30, 80, 80)});
    insert_vertex(db, map, vocabulary, row, image, edges, test_verifier(db));
    db.commit();
    if (v != 5) continue;
    traces = {row.name, text_of(std::span(bytes).subspan(100, 64)), text_of(std::span(bytes).subspan(15'000, 64)),
              text_of(std::span<const std::uint8_t>(blobs::encode_appearances(image)).subspan(40, 64))};
  }
  write_due_segments(store, {.vertices = 8});
  {
    WriteTransaction db = store.write();
    delete_vertices(db, map, VertexId{5}, 1, at(9));
    delete_image_bytes(db, map, VertexId{6});
    db.commit();
  }
  EXPECT_EQ(purge(store).exit_code, 2) << "while a server has the folder";
  store.close();
  for (const std::string& trace : traces)
    EXPECT_THAT(bytes_in(store.folder()).find(trace), ::testing::Ne(std::string::npos));
  const Ran run = purge(store);
  EXPECT_EQ(run.exit_code, 0) << run.errors;
  EXPECT_THAT(run.output, HasSubstr("lab: 1 images and 2 edges are gone, 1 segments"));
  const std::string left = bytes_in(store.folder());
  for (const std::string& trace : traces) EXPECT_EQ(left.find(trace), std::string::npos);
  EXPECT_NE(left.find("image-6"), std::string::npos);

  store.reopen();
  for (const Finding& finding : check_store(store.read()).findings)
    ADD_FAILURE() << finding.where << ": " << finding.what;
  EXPECT_EQ(standing_of(store.read(), map, VertexId{5}), VertexStanding::kPurged);
  EXPECT_FALSE(find_image(store.read(), map, "a-name-like-no-other"));
  EXPECT_EQ(load_index(store.read(), map, vocabulary).vertices(), 20u);
  WriteTransaction db = store.write();
  EXPECT_FALSE(restore_vertex(db, map, VertexId{5}));
  const AppearanceVector image = random_appearances(random, 80, kWords, true);
  EXPECT_EQ(insert_vertex(db, map, vocabulary, new_image("a-name-like-no-other", image), image, {}, test_verifier(db)),
            VertexId{20});
}

TEST(PurgeCommand, TakesOneMapAtATimeWhenTold) {
  TempStore store;
  const VocabularyId vocabulary = add_vocabulary(store, "words", kWords);
  Random random(3);
  std::vector<MapId> maps;
  for (const char* name : {"a", "b"}) {
    maps.push_back(add_map(store, name, vocabulary));
    add_vertex(store, maps.back(), vocabulary, "x", random_appearances(random, 50, kWords));
    WriteTransaction db = store.write();
    delete_vertices(db, maps.back(), VertexId{0}, 1, at(9));
    db.commit();
  }
  store.close();
  EXPECT_EQ(purge(store, " --map c").exit_code, 2);
  EXPECT_EQ(purge(store, " --map b").exit_code, 0);
  store.reopen();
  EXPECT_EQ(standing_of(store.read(), maps[0], VertexId{0}), VertexStanding::kDeleted);
  EXPECT_EQ(standing_of(store.read(), maps[1], VertexId{0}), VertexStanding::kPurged);
  store.close();
  EXPECT_THAT(purge(store, " --map a").output, HasSubstr("a: 1 images"));
}

}  // namespace
}  // namespace mapweld::test
