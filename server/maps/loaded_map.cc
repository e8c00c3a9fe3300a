#include "server/maps/loaded_map.h"

#include <algorithm>
#include <mutex>

#include "schema/maps/edge_store.h"
#include "schema/maps/vertex_store.h"
#include "schema/segments/segment_store.h"

namespace mapweld::server {
namespace {

constexpr std::size_t kVertexOverhead = 128;  // its entries in the vectors below, allocation included

std::size_t bytes_of(const AppearanceVector& vector) {
  return sizeof(AppearanceVector) + 32 +
         (vector.appearances.size() + vector.static_appearances.size()) * sizeof(Appearance);
}

// What a vertex adds that comes with its vector and so many edges to earlier ones.
std::size_t bytes_of_vertex(const AppearanceVector& vector, std::size_t edges) {
  return bytes_of(vector) + vector.appearances.size() * kBytesPerPosting + kVertexOverhead +
         2 * edges * sizeof(VertexId);
}

}  // namespace

LoadedMap::LoadedMap(Store& store, const Reader& db, const MapRow& map)
    : store_(store), map_(map.id), vocabulary_(map.vocabulary), index_(load_index(db, map.id, map.vocabulary)) {
  const std::uint32_t vertices = index_.vertices();
  links_.resize(vertices);
  vectors_.resize(vertices);
  const MapLayout layout = load_layout(db, map.id);
  std::size_t edges = 0;
  for (const auto of : {&Links::confirmed, &Links::withheld}) {
    for (const Edge& edge : load_edges(db, layout, {.confirmed = of == &Links::confirmed})) {
      (links_[to_index(edge.u)].*of).push_back(edge.v);
      (links_[to_index(edge.v)].*of).push_back(edge.u);
      ++edges;
    }
  }
  committed_ = vertices;
  memory_bytes_ = index_.memory_bytes() + vertices * kVertexOverhead + 2 * edges * sizeof(VertexId);
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
  const auto& found = links_.at(to_index(vertex)).confirmed;
  out.insert(out.end(), found.begin(), found.end());
}

void LoadedMap::linked(VertexId vertex, std::vector<VertexId>& out) const {
  const std::shared_lock lock(mutex_);
  const Links& found = links_.at(to_index(vertex));
  for (const auto* links : {&found.confirmed, &found.withheld}) out.insert(out.end(), links->begin(), links->end());
}

VertexId LoadedMap::append(std::shared_ptr<const AppearanceVector> vector, std::span<const VertexId> neighbours) {
  const std::unique_lock lock(mutex_);
  const VertexId added{index_.vertices()};
  index_.add(*vector);
  for (const VertexId neighbour : neighbours) links_.at(to_index(neighbour)).confirmed.push_back(added);
  links_.push_back({.confirmed = {neighbours.begin(), neighbours.end()}, .withheld = {}});
  memory_bytes_ += bytes_of_vertex(*vector, neighbours.size());
  vectors_.push_back(std::move(vector));
  return added;
}

void LoadedMap::set_confirmed(VertexId u, VertexId v, bool confirmed) {
  const std::unique_lock lock(mutex_);
  const auto move_over = [&](VertexId from, VertexId to) {
    Links& links = links_.at(to_index(from));
    std::erase(confirmed ? links.withheld : links.confirmed, to);
    std::vector<VertexId>& now = confirmed ? links.confirmed : links.withheld;
    if (std::ranges::find(now, to) == now.end()) now.push_back(to);
  };
  move_over(u, v);
  move_over(v, u);
}

void LoadedMap::commit() { committed_ = static_cast<std::uint32_t>(vectors_.size()); }

void LoadedMap::rollback() {
  const std::unique_lock lock(mutex_);
  index_.truncate(committed_);
  // The last first: what is left of a vertex' links are then those that it came with.
  for (std::size_t added = links_.size(); added-- > committed_;) {
    const std::vector<VertexId>& neighbours = links_[added].confirmed;
    memory_bytes_ -= bytes_of_vertex(*vectors_[added], neighbours.size());
    for (const VertexId neighbour : neighbours) {
      std::erase(links_.at(to_index(neighbour)).confirmed, VertexId{static_cast<std::uint32_t>(added)});
    }
  }
  links_.resize(committed_);
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
