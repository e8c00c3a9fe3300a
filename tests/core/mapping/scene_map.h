// A map in memory, grown by `decide`, and a verifier with made-up verdicts.
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "core/mapping/localizer.h"
#include "core/retrieval/inverted_index.h"

namespace mapweld::test {

class SceneMap final : public MapView {
 public:
  VertexId add(const AppearanceVector& image, const std::vector<VertexId>& neighbours = {}) {
    const VertexId id{index_.vertices()};
    index_.add(image);
    images_.push_back(std::make_shared<const AppearanceVector>(image));
    neighbours_.push_back(neighbours);
    for (const VertexId n : neighbours) neighbours_.at(to_index(n)).push_back(id);
    return id;
  }
  const PostingSource& postings() const override { return index_; }
  std::shared_ptr<const AppearanceVector> appearances(VertexId v) const override { return images_.at(to_index(v)); }
  std::optional<int> hops(VertexId u, VertexId v, int at_most) const override {
    std::vector<VertexId> ring{u};
    std::vector<bool> seen(size(), false);
    for (int distance = 0; distance <= at_most; ++distance) {
      std::vector<VertexId> next;
      for (const VertexId w : ring) {
        if (w == v) return distance;
        for (const VertexId n : neighbours_.at(to_index(w))) {
          if (!seen[to_index(n)]) next.push_back(n);
          seen[to_index(n)] = true;
        }
      }
      ring = std::move(next);
    }
    return std::nullopt;
  }
  std::vector<VertexId> linked(VertexId v) const override { return neighbours_.at(to_index(v)); }
  const AppearanceVector& image(std::size_t v) const { return *images_.at(v); }
  std::size_t size() const { return images_.size(); }

 private:
  InvertedIndex index_;
  std::vector<std::shared_ptr<const AppearanceVector>> images_;
  std::vector<std::vector<VertexId>> neighbours_;
};

// Verdicts by table: the name of an image is the x of its first appearance. Pairs not in the table are rejected.
class TableVerifier final : public PairVerifier {
 public:
  explicit TableVerifier(int min_inliers = 10) { options_.min_inliers = min_inliers; }
  void set(int a, int b, int inliers, Reason reason = Reason::kNone) {
    Verification v;
    v.accepted = reason == Reason::kNone;
    v.reason = reason;
    v.inliers = inliers;
    table_[{a, b}] = table_[{b, a}] = v;
  }
  Verification verify(const AppearanceVector& a, const AppearanceVector& b) const override {
    const auto it = table_.find({name(a), name(b)});
    if (it != table_.end()) return it->second;
    Verification v;
    v.reason = Reason::kTooFewInliers;
    return v;
  }
  std::string version() const override { return "table"; }
  const VerifierOptions& options() const override { return options_; }

  // An image called `name` with the words first .. first+count-1.
  static AppearanceVector image(int name, std::uint32_t first, std::uint32_t count) {
    AppearanceVector v{.width_px = 320, .height_px = 240, .appearances = {}};
    for (std::uint32_t w = first; w < first + count; ++w) {
      v.appearances.push_back({WordId{w}, static_cast<float>(name), 0, 4, 0});
    }
    return v;
  }

 private:
  static int name(const AppearanceVector& v) { return static_cast<int>(v.appearances.at(0).x_px); }
  std::map<std::pair<int, int>, Verification> table_;
  VerifierOptions options_;
};

}  // namespace mapweld::test
