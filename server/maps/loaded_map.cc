#include "server/maps/loaded_map.h"

#include <algorithm>
#include <mutex>

#include "schema/edge_store.h"
#include "schema/segment_store.h"
#include "schema/vertex_store.h"

namespace mapweld::server {
namespace {

constexpr std::size_t kVertexOverhead = 128;  // its entries in the vectors below, allocation included

std::size_t bytes_of(const AppearanceVector& vector) {
  return sizeof(AppearanceVector) + vector.appearances.size() * sizeof(Appearance) + 32;
}

}  // namespace

LoadedMap::LoadedMap(Store& store, const Reader& db, const MapRow& map)
    : store_(store), map_(map.id), vocabulary_(map.vocabulary), index_(load_index(db, map.id, map.vocabulary)) {
  const std::uint32_t vertices = index_.vertices();
  neighbours_.resize(vertices);
  vectors_.resize(vertices);
  const std::vector<Edge> edges = load_edges(db, load_layout(db, map.id), {.confirmed = true});
  for (const Edge& edge : edges) {
    neighbours_[to_index(edge.u)].push_back(edge.v);
    neighbours_[to_index(edge.v)].push_back(edge.u);
  }
  committed_ = vertices;
  memory_bytes_ = index_.memory_bytes() + vertices * kVertexOverhead + 2 * edges.size() * sizeof(VertexId);
}

void LoadedMap::visit(WordId word, VertexId first, VertexId end, const Visitor& visitor) const {
  const std::shared_lock lock(mutex_);
  const PostingSpan part = index_.find(word).between(first, end);
  if (!part.empty()) visitor(part);
}

std::shared_ptr<const AppearanceVector> LoadedMap::appearances(VertexId vertex) const {
  {
    const std::shared_lock lock(mutex_);
    if (const auto& vector = vectors_.at(to_index(vertex))) return vector;
  }
  auto vector = std::make_shared<const AppearanceVector>(load_appearances(store_.read(), map_, vocabulary_, vertex));
  const std::unique_lock lock(mutex_);
  auto& slot = vectors_.at(to_index(vertex));
  if (!slot) {
    memory_bytes_ += bytes_of(*vector);
    slot = std::move(vector);
  }
  return slot;
}

void LoadedMap::neighbours(VertexId vertex, std::vector<VertexId>& out) const {
  const std::shared_lock lock(mutex_);
  const auto& found = neighbours_.at(to_index(vertex));
  out.insert(out.end(), found.begin(), found.end());
}

VertexId LoadedMap::append(std::shared_ptr<const AppearanceVector> vector, std::span<const VertexId> neighbours) {
  const std::unique_lock lock(mutex_);
  const VertexId added{index_.vertices()};
  index_.add(*vector);
  for (const VertexId neighbour : neighbours) neighbours_.at(to_index(neighbour)).push_back(added);
  neighbours_.emplace_back(neighbours.begin(), neighbours.end());
  memory_bytes_ += bytes_of(*vector) + vector->appearances.size() * kBytesPerPosting + kVertexOverhead +
                   2 * neighbours.size() * sizeof(VertexId);
  vectors_.push_back(std::move(vector));
  return added;
}

void LoadedMap::set_linked(VertexId u, VertexId v, bool linked) {
  const std::unique_lock lock(mutex_);
  const auto set = [&](VertexId from, VertexId to) {
    std::vector<VertexId>& links = neighbours_.at(to_index(from));
    const auto found = std::ranges::find(links, to);
    if (linked && found == links.end()) links.push_back(to);
    if (!linked && found != links.end()) links.erase(found);
  };
  set(u, v);
  set(v, u);
}

void LoadedMap::commit() { committed_ = static_cast<std::uint32_t>(vectors_.size()); }

void LoadedMap::rollback() {
  const std::unique_lock lock(mutex_);
  index_.truncate(committed_);
  for (std::size_t added = committed_; added < neighbours_.size(); ++added) {
    for (const VertexId neighbour : neighbours_[added]) {
      std::erase(neighbours_.at(to_index(neighbour)), VertexId{static_cast<std::uint32_t>(added)});
    }
  }
  neighbours_.resize(committed_);
  vectors_.resize(committed_);
}

void LoadedMap::shed_appearances() {
  const std::unique_lock lock(mutex_);
  for (std::size_t i = 0; i < committed_; ++i) {
    if (!vectors_[i]) continue;
    memory_bytes_ -= bytes_of(*vectors_[i]);
    vectors_[i].reset();
  }
}

std::size_t estimated_index_bytes(std::uint32_t vertices, int max_features) {
  return std::size_t{vertices} * (static_cast<std::size_t>(max_features) * kBytesPerPosting + kVertexOverhead);
}

}  // namespace mapweld::server
