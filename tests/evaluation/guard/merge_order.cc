#include "tests/evaluation/guard/merge_order.h"

#include <algorithm>
#include <map>
#include <memory>
#include <random>
#include <stdexcept>
#include <utility>

#include "core/merge/make_merger.h"

namespace mapweld::evaluation {
namespace {

// Knows pairs by where their images lie in memory.
class KnownVerdicts final : public PairVerifier {
 public:
  explicit KnownVerdicts(const rendered::MadeMerge& merge) {
    const auto image = [&](VertexId v) {
      const std::size_t i = to_index(v), n = merge.a.vertices.size();
      return (i < n ? merge.a.vertices[i] : merge.b.vertices[i - n]).get();
    };
    for (const MergeEdge& edge : merge.inter_edges) known_[{image(edge.u), image(edge.v)}] = &edge.verification;
  }
  Verification verify(const AppearanceVector& a, const AppearanceVector& b) const override {
    if (const auto found = known_.find({&a, &b}); found != known_.end()) return *found->second;
    if (const auto found = known_.find({&b, &a}); found != known_.end()) return mirrored(*found->second);
    return {};
  }
  std::string version() const override { return "known"; }
  const VerifierOptions& options() const override { return options_; }

 private:
  std::map<std::pair<const AppearanceVector*, const AppearanceVector*>, const Verification*> known_;
  VerifierOptions options_;
};

}  // namespace

MergeInput known_merge(const JudgedMerge& judged, std::vector<Edge> inner_edges) {
  MergeInput input;
  input.members = judged.merge.members();
  input.inner_edges = std::move(inner_edges);
  input.appearances = std::make_shared<AppearanceTable>(judged.merge.appearances());
  input.verifier = std::make_shared<KnownVerdicts>(judged.merge);
  input.options.method = "spectral";
  return input;
}

std::vector<MergeEdge> edges_as_found(const JudgedMerge& judged) {
  std::vector<Edge> inner;
  for (const VerifiedEdge& edge : judged.inner) {
    inner.push_back({edge.u, edge.v, static_cast<std::uint32_t>(edge.inlier_matches.size())});
  }
  const auto merger = make_merger(known_merge(judged, std::move(inner)));
  while (!merger->done()) merger->step();
  std::vector<MergeEdge> edges = merger->state().edges;
  if (edges.size() != judged.merge.inter_edges.size())
    throw std::logic_error("spectral finds other edges than there are");
  return edges;
}

std::vector<MergeEdge> edges_at_random(const JudgedMerge& judged, std::uint64_t seed) {
  std::vector<MergeEdge> edges = judged.merge.inter_edges;
  std::mt19937_64 random(seed);
  for (std::size_t i = edges.size(); i > 1; --i) std::swap(edges[i - 1], edges[random() % i]);
  return edges;
}

}  // namespace mapweld::evaluation
