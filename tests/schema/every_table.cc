#include "tests/schema/every_table.h"

#include <openssl/sha.h>

#include "schema/answer_store.h"
#include "schema/maps/camera_store.h"
#include "schema/maps/mask_store.h"
#include "schema/maps/purge.h"
#include "schema/maps/vertex_removal.h"
#include "schema/merges/merge_store.h"
#include "schema/ownership_store.h"
#include "schema/segments/segment_store.h"

namespace mapweld::test {

EveryTable::EveryTable(Store& store)
    : vocabulary(add_vocabulary(store)), a(add_map(store, "a", vocabulary)), b(add_map(store, "b", vocabulary)) {
  Random random(71);
  for (const MapId map : {a, b}) {
    for (std::uint32_t v = 0; v < 20; ++v) {
      const AppearanceVector appearances = random_appearances(random, 40, 1'000);
      const auto bytes = random_bytes(random, 500);
      NewImage image = new_image(std::to_string(v), appearances);
      SHA256(bytes.data(), bytes.size(), image.sha256.data());
      image.bytes = bytes;
      image.owner = 7;
      if (v == 7) image.provenance.pose = R"({"frame":"lab"})";
      std::vector<NewEdge> edges;
      if (v > 0) edges.push_back({VertexId{v - 1}, {}, 30, random_verification(random, 15, 40, 40)});
      WriteTransaction db = store.write();
      insert_vertex(db, map, vocabulary, image, appearances, edges, test_verifier(db));
      db.commit();
    }
  }
  WriteTransaction db = store.write();
  insert_ignored(db, a, new_image("ignored", {}), VertexId{3}, 200);
  const std::vector<std::uint8_t> mask_bytes(50, 3);
  MaskRow mask{.width_px = 8, .height_px = 6, .used_pixels = 40, .set_at = at(0)};
  SHA256(mask_bytes.data(), mask_bytes.size(), mask.sha256.data());
  set_mask(db, a, mask, mask_bytes);
  set_map_camera(db, a, R"({"model":"pinhole"})");
  const MapId merged = insert_merged_map(db, new_map("ab", vocabulary), std::vector{a, b});
  const JobId job = insert_merge(db, {merged, "quickconnect", 7, "{}", "{}", at(0)});
  const std::uint64_t epoch = claim_merge(db, job, at(1)).value();
  own_merge(db, job, 7);
  MergeState state;
  state.method = "quickconnect";
  state.vertices = 40;
  state.edges.push_back({VertexId{4}, VertexId{24}, 30, random_verification(random, 15, 40, 40), 1});
  state.verifications = 1;
  save_state(db, job, epoch, state);
  db.prepare(
        "INSERT INTO curve_points (job, step, elapsed_s, verifications, edges, components, algebraic_connectivity, "
        "largest_vertices, largest_algebraic_connectivity, phase) VALUES (?, 1, 0.5, 1, 1, 39, 0, 2, 2, 'bridging')")
      .bind(1, job)
      .run();
  keep_answer(db, {7, "a key"},
              {.part = 1,
               .request = mask.sha256,
               .status = 201,
               .headers = "a: b\n",
               .body = "{}",
               .map = a,
               .kept_at = at(4)});
  db.prepare("INSERT INTO meta (key, value) VALUES ('made_by', 'a test')").run();
  const auto insert_and_delete = [&](const char* name, const std::vector<NewEdge>& edges) {
    const AppearanceVector appearances = random_appearances(random, 40, 1'000);
    const VertexId vertex =
        insert_vertex(db, b, vocabulary, new_image(name, appearances), appearances, edges, test_verifier(db));
    delete_vertices(db, b, vertex, 1, at(3));
  };
  insert_and_delete("purged", {});
  purge_deleted(db, b);
  insert_and_delete("deleted", {{VertexId{19}, {}, 30, random_verification(random, 15, 40, 40)}});
  db.commit();
  write_due_segments(store, {8, 2, 16});
}

}  // namespace mapweld::test
