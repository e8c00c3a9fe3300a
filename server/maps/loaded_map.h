// A plain map in memory: inverted index, graph, and the appearance vectors that were asked for so far.
#pragma once

#include <atomic>
#include <cstdint>
#include <memory>
#include <shared_mutex>
#include <span>
#include <vector>

#include "core/retrieval/inverted_index.h"
#include "schema/maps/map_store.h"
#include "schema/store.h"
#include "server/maps/leaf_source.h"

namespace mapweld::server {

// Reading: any thread, also beside the writer. Writing: one thread at a time, the one that has the map's turn
// (MapCache::writer_turn).
class LoadedMap final : public LeafSource {
 public:
  // Reads the map as `db` sees it. `store` must outlive this: vectors are read from it later.
  LoadedMap(Store& store, const Reader& db, const MapRow& map);

  void visit(WordId word, VertexId first, VertexId end, const Visitor& visitor) const override;
  std::shared_ptr<const AppearanceVector> appearances(VertexId vertex) const override;
  void neighbours(VertexId vertex, std::vector<VertexId>& out) const override;
  void linked(VertexId vertex, std::vector<VertexId>& out) const override;

  // Vertices that are stored for good.
  std::uint32_t committed() const { return committed_; }

  // Adds the next vertex with its edges to earlier ones; not stored yet, so readers do not look for it yet. Returns its
  // number: another than the store is about to give says that this map is not the stored one.
  VertexId append(std::shared_ptr<const AppearanceVector> vector, std::span<const VertexId> neighbours);
  // An edge between two vertices that are stored is confirmed from now on, or no longer is.
  void set_confirmed(VertexId u, VertexId v, bool confirmed);
  // What was appended is stored.
  void commit();
  // Storing failed: forgets what was appended since the last commit().
  void rollback();

  // What it occupies, about.
  std::size_t memory_bytes() const { return memory_bytes_; }
  // Forgets the appearance vectors that can be read again.
  void shed_appearances();

 private:
  Store& store_;
  const MapId map_;
  const VocabularyId vocabulary_;

  mutable std::shared_mutex mutex_;  // guards what follows
  InvertedIndex index_;
  struct Links {
    std::vector<VertexId> confirmed;
    std::vector<VertexId> withheld;
  };
  std::vector<Links> links_;
  mutable std::vector<std::shared_ptr<const AppearanceVector>> vectors_;  // null: not read yet

  std::atomic<std::uint32_t> committed_{0};
  mutable std::atomic<std::size_t> memory_bytes_{0};
};

// How much memory the index of a map with so many vertices takes, about; grows with `vertices`.
std::size_t estimated_index_bytes(std::uint32_t vertices, int max_features);

}  // namespace mapweld::server
