#include "tests/evaluation/guard/guard_counts.h"

#include <chrono>
#include <utility>

namespace mapweld::evaluation {
namespace {

using Clock = std::chrono::steady_clock;

constexpr float kPlaceShared = 0.3f;
constexpr std::size_t kPlaceFeatures = 50;
constexpr int kClusterLinks = 2;

double ms_since(Clock::time_point start) {
  return std::chrono::duration<double, std::milli>(Clock::now() - start).count();
}

// By merged vertex: those within two inner edges, itself first.
std::vector<std::vector<std::uint32_t>> near_vertices(const JudgedMerge& judged) {
  const std::size_t n = judged.images.size();
  std::vector<std::vector<std::uint32_t>> linked(n), near(n);
  for (const VerifiedEdge& e : judged.inner) {
    linked[to_index(e.u)].push_back(to_index(e.v));
    linked[to_index(e.v)].push_back(to_index(e.u));
  }
  std::vector<std::size_t> seen(n, n);
  for (std::uint32_t v = 0; v < n; ++v) {
    near[v] = {v};
    seen[v] = v;
    std::size_t from = 0;
    for (int link = 0; link < kClusterLinks; ++link) {
      for (const std::size_t end = near[v].size(); from < end; ++from) {
        for (const std::uint32_t next : linked[near[v][from]]) {
          if (seen[next] != v) near[v].push_back(next);
          seen[next] = v;
        }
      }
    }
  }
  return near;
}

std::size_t wrong_joins(const JudgedMerge& judged, const std::vector<std::size_t>& edges) {
  const auto near = near_vertices(judged);
  std::vector<std::vector<std::size_t>> at(near.size());
  for (const std::size_t e : edges) at[to_index(judged.merge.inter_edges[e].u)].push_back(e);
  std::vector<bool> taken(judged.merge.inter_edges.size(), false), beside(near.size(), false);
  std::size_t count = 0;
  for (const std::size_t start : edges) {
    if (taken[start]) continue;
    taken[start] = true;
    std::vector<std::size_t> cluster{start};
    bool all_wrong = true;
    for (std::size_t i = 0; i < cluster.size(); ++i) {
      const MergeEdge& e = judged.merge.inter_edges[cluster[i]];
      all_wrong = all_wrong && judged.inter_truth[cluster[i]] == Truth::kWrong;
      for (const std::uint32_t v : near[to_index(e.v)]) beside[v] = true;
      for (const std::uint32_t u : near[to_index(e.u)]) {
        for (const std::size_t f : at[u]) {
          if (taken[f] || !beside[to_index(judged.merge.inter_edges[f].v)]) continue;
          taken[f] = true;
          cluster.push_back(f);
        }
      }
      for (const std::uint32_t v : near[to_index(e.v)]) beside[v] = false;
    }
    count += all_wrong ? 1 : 0;
  }
  return count;
}

void count_places(const JudgedMerge& judged, const std::vector<std::size_t>& verified,
                  const std::vector<std::size_t>& confirmed, GuardCounts& counts) {
  const auto& merge = judged.merge;
  const auto has_right = [&](const std::vector<std::size_t>& edges) {
    std::vector<bool> has(merge.b.vertices.size(), false);
    for (const std::size_t e : edges) {
      if (judged.inter_truth[e] == Truth::kRight)
        has[to_index(merge.inter_edges[e].v) - merge.a.vertices.size()] = true;
    }
    return has;
  };
  const auto by_verified = has_right(verified), by_confirmed = has_right(confirmed);
  for (std::size_t v = 0; v < merge.best_shared.size(); ++v) {
    if (merge.best_shared[v] < kPlaceShared || merge.b.vertices[v]->appearances.size() < kPlaceFeatures) continue;
    ++counts.places;
    counts.places_verified += by_verified[v] ? 1 : 0;
    counts.places_confirmed += by_confirmed[v] ? 1 : 0;
  }
}

}  // namespace

void EdgeCounts::add(Truth truth) { ++(truth == Truth::kRight ? right : truth == Truth::kWrong ? wrong : unknown); }

EdgeCounts& EdgeCounts::operator+=(const EdgeCounts& other) {
  right += other.right;
  wrong += other.wrong;
  unknown += other.unknown;
  return *this;
}

Joined& Joined::operator+=(const Joined& other) {
  a += other.a;
  b += other.b;
  return *this;
}

GuardCounts& GuardCounts::operator+=(const GuardCounts& other) {
  candidates += other.candidates;
  verified += other.verified;
  confirmed += other.confirmed;
  joined_by_verified += other.joined_by_verified;
  joined += other.joined;
  inner_verified += other.inner_verified;
  inner_confirmed += other.inner_confirmed;
  wrong_joins_verified += other.wrong_joins_verified;
  wrong_joins += other.wrong_joins;
  places += other.places;
  places_verified += other.places_verified;
  places_confirmed += other.places_confirmed;
  members_ms += other.members_ms;
  edges_ms += other.edges_ms;
  return *this;
}

Joined joined_by(const JudgedMerge& judged, const std::vector<std::size_t>& edges) {
  std::vector<bool> is_joined(judged.images.size(), false);
  for (const std::size_t e : edges) {
    is_joined[to_index(judged.merge.inter_edges[e].u)] = true;
    is_joined[to_index(judged.merge.inter_edges[e].v)] = true;
  }
  Joined joined;
  for (std::size_t v = 0; v < is_joined.size(); ++v) {
    if (is_joined[v]) (v < judged.merge.a.vertices.size() ? joined.a : joined.b) += judged.images[v];
  }
  return joined;
}

GuardRun run_guard(const JudgedMerge& judged, const GuardOptions& options) {
  const auto appearances = judged.merge.appearances();
  GuardRun run;
  GuardCounts& counts = run.counts;
  const auto start = Clock::now();
  AliasGuard guard(judged.merge.members(), judged.inner, appearances, options);
  counts.members_ms = ms_since(start);
  const auto constructed = Clock::now();
  run.inter = guard.verdicts(judged.merge.inter_edges);
  counts.edges_ms = ms_since(constructed);
  run.inner = guard.inner_verdicts();

  counts.candidates = judged.merge.candidates;
  std::vector<std::size_t> verified, confirmed, verified_not_wrong, confirmed_not_wrong;
  for (std::size_t e = 0; e < run.inter.size(); ++e) {
    const Truth truth = judged.inter_truth[e];
    counts.verified.add(truth);
    verified.push_back(e);
    if (truth != Truth::kWrong) verified_not_wrong.push_back(e);
    if (!run.inter[e].confirmed()) continue;
    counts.confirmed.add(truth);
    confirmed.push_back(e);
    if (truth != Truth::kWrong) confirmed_not_wrong.push_back(e);
  }
  for (std::size_t e = 0; e < run.inner.size(); ++e) {
    counts.inner_verified.add(judged.inner_truth[e]);
    if (run.inner[e].confirmed()) counts.inner_confirmed.add(judged.inner_truth[e]);
  }
  counts.joined_by_verified = joined_by(judged, verified_not_wrong);
  counts.joined = joined_by(judged, confirmed_not_wrong);
  counts.wrong_joins_verified = wrong_joins(judged, verified);
  counts.wrong_joins = wrong_joins(judged, confirmed);
  count_places(judged, verified, confirmed, counts);
  return run;
}

}  // namespace mapweld::evaluation
