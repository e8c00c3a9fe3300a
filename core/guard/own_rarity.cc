#include "core/guard/own_rarity.h"

#include <algorithm>
#include <stdexcept>
#include <utility>

#include "core/geometry/nearest_signatures.h"

namespace mapweld {
namespace {

constexpr int kSameThing = 32;  // bits

}  // namespace

OwnRarity::OwnRarity(ImageLookup images, std::vector<std::vector<std::uint32_t>> neighbours)
    : neighbours_(std::move(neighbours)), known_(neighbours_.size()), near_(neighbours_.size(), 0) {
  struct Entry {
    WordId word{};
    Holder holder;
  };
  std::vector<Entry> entries;
  for (std::uint32_t v = 0; v < neighbours_.size(); ++v) {
    images_.push_back(images(v));
    const auto& appearances = images_.back()->appearances;
    for (std::size_t i = 0; i < appearances.size(); ++i) {
      entries.push_back({appearances[i].word, {v, static_cast<std::uint16_t>(i)}});
    }
  }
  std::ranges::stable_sort(entries, {}, &Entry::word);
  for (const Entry& entry : entries) {
    if (words_.empty() || words_.back() != entry.word) {
      words_.push_back(entry.word);
      offsets_.push_back(static_cast<std::uint32_t>(holders_.size()));
    }
    holders_.push_back(entry.holder);
  }
  offsets_.push_back(static_cast<std::uint32_t>(holders_.size()));
}

std::uint32_t OwnRarity::far_images(std::uint32_t vertex) {
  learn(vertex);
  return known_[vertex].far_images;
}

double OwnRarity::common_share(std::uint32_t vertex) {
  learn(vertex);
  return known_[vertex].common_share;
}

const std::vector<bool>& OwnRarity::rare(std::uint32_t vertex) {
  learn(vertex);
  return known_[vertex].rare;
}

int OwnRarity::rare_matches(std::uint32_t u, OwnRarity& other, std::uint32_t v, const VerifiedEdge& edge) {
  const std::vector<bool>& here = rare(u);
  const std::vector<bool>& there = other.rare(v);
  int both = 0;
  for (const auto& [i, j] : edge.inlier_matches) {
    if (i >= here.size() || j >= there.size()) throw std::invalid_argument("an edge's matches are not of its images");
    both += here[i] && there[j] ? 1 : 0;
  }
  return both;
}

void OwnRarity::learn_linked(const Executor* executor) {
  constexpr std::size_t kVertices = 64;  // of a piece
  const std::size_t vertices = neighbours_.size();
  run_pieces(executor, (vertices + kVertices - 1) / kVertices, [&](std::size_t piece) {
    NearTo near(vertices, 0);
    for (std::size_t v = piece * kVertices; v < std::min(vertices, (piece + 1) * kVertices); ++v) {
      if (!neighbours_[v].empty()) learn(static_cast<std::uint32_t>(v), near);
    }
  });
}

void OwnRarity::learn(std::uint32_t vertex, NearTo& near_to) {
  Known& known = known_[vertex];
  if (known.is_known) return;
  const std::uint32_t stamp = vertex + 1;
  std::uint32_t near = 0;
  const auto mark = [&](std::uint32_t v) {
    near += near_to[v] == stamp ? 0 : 1;
    near_to[v] = stamp;
  };
  mark(vertex);
  for (const std::uint32_t n : neighbours_[vertex]) {
    mark(n);
    for (const std::uint32_t m : neighbours_[n]) mark(m);
  }
  known.far_images = static_cast<std::uint32_t>(neighbours_.size()) - near;
  const auto& appearances = images_[vertex]->appearances;
  known.rare.assign(appearances.size(), true);
  for (std::size_t i = 0; i < appearances.size(); ++i) {
    const auto word = std::ranges::lower_bound(words_, appearances[i].word) - words_.begin();
    for (std::uint32_t k = offsets_[static_cast<std::size_t>(word)]; k < offsets_[static_cast<std::size_t>(word) + 1];
         ++k) {
      const Holder& holder = holders_[k];
      if (near_to[holder.vertex] == stamp) continue;
      const Signature& other = images_[holder.vertex]->appearances[holder.appearance].signature;
      if (hamming_distance(appearances[i].signature, other) <= kSameThing) {
        known.rare[i] = false;
        break;
      }
    }
  }
  const auto common = static_cast<double>(std::ranges::count(known.rare, false));
  if (common > 0) known.common_share = common / static_cast<double>(appearances.size());
  known.is_known = true;
}

}  // namespace mapweld
