// Made worlds for the alias guard: drives, what their images match, and what the guard makes of it.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <utility>
#include <vector>

#include "core/geometry/pair_verifier.h"
#include "core/guard/alias_guard.h"

namespace mapweld::test {

// Drives of images with a hundred features each on a regular grid. Every feature has a word of its own unless a test
// says otherwise. Inner edges link each image to the two before it.
class GuardWorld {
 public:
  explicit GuardWorld(std::vector<std::uint32_t> sizes) : members_(number_members(sizes)) {
    for (const MergeMember& member : members_) {
      for (std::size_t i = 0; i < member.vertices.size(); ++i) {
        const std::uint32_t v = to_index(member.vertices[i]);
        images_.push_back(image(1000 * (v + 1)));
        for (std::uint32_t back = 1; back <= 2 && back <= i; ++back) link(v - back, v);
      }
    }
  }

  // Merged number of a member's vertex.
  std::uint32_t at(std::size_t member, std::uint32_t own) const { return to_index(members_[member].vertices[own]); }
  void link(std::uint32_t u, std::uint32_t v, std::uint32_t inliers = 60) {
    inner_.push_back({VertexId{u}, VertexId{v}, matches(0, static_cast<std::uint16_t>(inliers))});
  }

  // Features first..last-1 of u and v match and lie at the same place in both images.
  void join(std::uint32_t u, std::uint32_t v, std::uint16_t first = 0, std::uint16_t last = 60) {
    MergeEdge edge;
    edge.u = VertexId{u};
    edge.v = VertexId{v};
    edge.votes = 100;
    edge.verification.accepted = true;
    edge.verification.inliers = last - first;
    edge.verification.matches = last - first;
    edge.verification.log10_false_alarms = -40;
    edge.verification.inlier_matches = matches(first, last);
    edges_.push_back(edge);
  }
  // Images u.. of one map along v.. of another; the last features of each match.
  void join_drives(std::uint32_t u, std::uint32_t v, std::uint32_t images, std::uint16_t matches) {
    for (std::uint32_t i = 0; i < images; ++i) join(u + i, v + i, static_cast<std::uint16_t>(100 - matches), 100);
  }
  void set_word(std::uint32_t v, std::size_t feature, std::uint32_t word) {
    images_[v].appearances[feature].word = WordId{word};
  }
  void set_signature(std::uint32_t v, std::size_t feature, Signature signature) {
    images_[v].appearances[feature].signature = signature;
  }
  GuardOptions options;

  // The source stays with the world.
  AliasGuard guard(const Executor* executor = nullptr) const {
    std::vector<std::shared_ptr<const AppearanceVector>> vectors;
    for (const auto& v : images_) {
      AppearanceVector sorted = v;
      std::ranges::stable_sort(sorted.appearances, {}, &Appearance::word);
      vectors.push_back(std::make_shared<const AppearanceVector>(std::move(sorted)));
    }
    tables_.push_back(std::make_shared<AppearanceTable>(std::move(vectors)));
    return AliasGuard(members_, inner_, *tables_.back(), options, executor);
  }
  std::vector<GuardVerdict> verdicts(const std::vector<MergeEdge>& edges) const {
    guard();  // makes a source
    return guard_edges(members_, inner_, edges, *tables_.back(), options);
  }
  std::vector<GuardVerdict> verdicts() const { return verdicts(edges_); }
  const std::vector<MergeEdge>& edges() const { return edges_; }
  const std::vector<MergeMember>& members() const { return members_; }

  // The same world with members 0 and 1 exchanged, and every edge's ends with them.
  GuardWorld exchanged() const {
    GuardWorld other({static_cast<std::uint32_t>(members_[1].vertices.size()),
                      static_cast<std::uint32_t>(members_[0].vertices.size())});
    const auto moved = [&](VertexId v) {
      const auto n0 = static_cast<std::uint32_t>(members_[0].vertices.size());
      const auto n1 = static_cast<std::uint32_t>(members_[1].vertices.size());
      return VertexId{to_index(v) < n0 ? to_index(v) + n1 : to_index(v) - n0};
    };
    other.inner_.clear();
    for (const VerifiedEdge& e : inner_) other.inner_.push_back({moved(e.u), moved(e.v), e.inlier_matches});
    for (std::uint32_t v = 0; v < images_.size(); ++v) other.images_[to_index(moved(VertexId{v}))] = images_[v];
    for (const MergeEdge& e : edges_) {
      MergeEdge mirrored_edge = e;
      mirrored_edge.u = moved(e.v);
      mirrored_edge.v = moved(e.u);
      mirrored_edge.verification = mirrored(e.verification);
      other.edges_.push_back(mirrored_edge);
    }
    return other;
  }

 private:
  static std::vector<std::pair<std::uint16_t, std::uint16_t>> matches(std::uint16_t first, std::uint16_t last) {
    std::vector<std::pair<std::uint16_t, std::uint16_t>> all;
    for (std::uint16_t i = first; i < last; ++i) all.emplace_back(i, i);
    return all;
  }
  static AppearanceVector image(std::uint32_t first_word) {
    AppearanceVector v{.width_px = 320, .height_px = 240, .appearances = {}};
    for (std::uint32_t f = 0; f < 100; ++f) {
      // Scattered over the image: feature f lies far from f + 1.
      const std::uint32_t place = f * 37 % 100;
      v.appearances.push_back({WordId{first_word + f}, 16.0f + 32 * static_cast<float>(place % 10),
                               12.0f + 24 * static_cast<float>(place / 10), 4, 0});
    }
    return v;
  }

  std::vector<MergeMember> members_;
  std::vector<VerifiedEdge> inner_;
  std::vector<AppearanceVector> images_;
  mutable std::vector<std::shared_ptr<AppearanceTable>> tables_;
  std::vector<MergeEdge> edges_;
};

}  // namespace mapweld::test
