#include "core/merge/drive_links.h"

#include <algorithm>

#include "core/merge/edge_relations.h"
#include "core/merge/hop_balls.h"

namespace mapweld {
namespace {

constexpr int kLinkHops = 1;

struct Vertices {
  std::vector<std::uint32_t> member, position, features;  // by merged number
};

Vertices describe(const std::vector<MergeMember>& members, const AppearanceSource& appearances) {
  Vertices v;
  for (std::uint32_t m = 0; m < members.size(); ++m) {
    for (std::uint32_t i = 0; i < members[m].vertices.size(); ++i) {
      const std::uint32_t id = to_index(members[m].vertices[i]);
      if (id >= v.member.size()) {
        for (auto* list : {&v.member, &v.position, &v.features}) list->resize(id + 1, 0);
      }
      v.member[id] = m;
      v.position[id] = i;
      v.features[id] = static_cast<std::uint32_t>(appearances.appearances(members[m].vertices[i])->appearances.size());
    }
  }
  return v;
}

// Matched features, as a share of those of the image that has fewer.
double share_of_features(const WeighedEdge& e, const Vertices& vertices) {
  const std::uint32_t features = std::min(vertices.features[to_index(e.u)], vertices.features[to_index(e.v)]);
  return static_cast<double>(e.weight) / std::max(1u, features);
}

std::uint32_t images_apart(const Edge& e, const Vertices& vertices) {
  const std::uint32_t i = vertices.position.at(to_index(e.u)), j = vertices.position.at(to_index(e.v));
  return i < j ? j - i : i - j;
}

// The best share of matched features that each vertex has over some edges.
class BestShare {
 public:
  explicit BestShare(std::size_t vertices) : share_(vertices, 0) {}
  void see(const WeighedEdge& e, const Vertices& vertices) {
    const std::uint32_t u = to_index(e.u), v = to_index(e.v);
    const double share = share_of_features(e, vertices);
    share_[u] = std::max(share_[u], share);
    share_[v] = std::max(share_[v], share);
  }
  double operator[](std::uint32_t vertex) const { return share_[vertex]; }
  void forget(std::uint32_t vertex) { share_[vertex] = 0; }

 private:
  std::vector<double> share_;
};

}  // namespace

std::vector<Edge> drive_links(const std::vector<MergeMember>& members, std::span<const Edge> inner_edges,
                              const AppearanceSource& appearances, const DriveLinkOptions& options) {
  const Vertices vertices = describe(members, appearances);
  std::vector<Edge> links;
  std::vector<WeighedEdge> closing;
  BestShare neighbours(vertices.member.size());
  for (const Edge& e : inner_edges) {
    if (images_apart(e, vertices) <= options.longest_link) {
      links.push_back(e);
      neighbours.see({e.u, e.v, e.weight}, vertices);
    } else {
      closing.push_back({e.u, e.v, e.weight});
    }
  }
  if (closing.empty()) return links;

  HopBalls balls(members, links, kLinkHops);
  const auto cluster_of = EdgeRelations(closing, vertices.member, balls, kLinkHops).clusters(kLinkHops);
  std::vector<std::vector<std::uint32_t>> clusters;
  for (std::uint32_t e = 0; e < closing.size(); ++e) {
    if (cluster_of[e] == clusters.size()) clusters.emplace_back();
    clusters[cluster_of[e]].push_back(e);
  }
  BestShare other_pass(vertices.member.size());
  for (const auto& cluster : clusters) {
    std::vector<std::uint32_t> ends;
    for (const std::uint32_t e : cluster) {
      other_pass.see(closing[e], vertices);
      ends.push_back(to_index(closing[e].u));
      ends.push_back(to_index(closing[e].v));
    }
    std::ranges::sort(ends);
    ends.erase(std::ranges::unique(ends).begin(), ends.end());
    const auto full = std::ranges::count_if(
        ends, [&](std::uint32_t v) { return other_pass[v] >= options.revisit_fullness * neighbours[v]; });
    if (ends.size() >= options.min_revisit_images &&
        static_cast<double>(full) >= options.revisit_completeness * static_cast<double>(ends.size())) {
      for (const std::uint32_t e : cluster) links.push_back({closing[e].u, closing[e].v, closing[e].weight});
    }
    for (const std::uint32_t v : ends) other_pass.forget(v);
  }
  return links;
}

std::vector<Edge> short_links(const std::vector<MergeMember>& members, std::span<const Edge> links,
                              const AppearanceSource& appearances, double min_share, const DriveLinkOptions& options) {
  const Vertices vertices = describe(members, appearances);
  std::vector<Edge> kept;
  for (const Edge& e : links) {
    if (images_apart(e, vertices) > options.longest_link ||
        share_of_features({e.u, e.v, e.weight}, vertices) >= min_share) {
      kept.push_back(e);
    }
  }
  return kept;
}

}  // namespace mapweld
