#include "core/merge/cluster_contest.h"

#include <algorithm>
#include <map>
#include <utility>

namespace mapweld {
namespace {

using Pair = std::pair<std::uint32_t, std::uint32_t>;

class Contest {
 public:
  Contest(std::span<const ClusterBond> bonds, const std::vector<bool>& out) : bonds_(bonds), standings_(out.size()) {
    for (std::size_t c = 0; c < out.size(); ++c) {
      if (out[c]) standings_[c].reason = Reason::kUnsupported;
    }
  }

  bool stands(std::uint32_t c) const { return standings_[c].reason == Reason::kNone; }

  // What those that stand say.
  void weigh() {
    for (ClusterStanding& s : standings_) s.support = s.contradiction = 0;
    for (const ClusterBond& b : bonds_) {
      if (b.of != b.from && !stands(b.from)) continue;
      standings_[b.of].support += b.support;
      standings_[b.of].contradiction += b.contradiction;
    }
  }

  void drop_outweighed(double times) {
    std::vector<std::uint32_t> dropped;
    do {
      weigh();
      dropped.clear();
      for (std::uint32_t c = 0; c < standings_.size(); ++c) {
        if (stands(c) && outweighed(c, times)) dropped.push_back(c);
      }
      for (const std::uint32_t c : dropped) standings_[c].reason = Reason::kUnsupported;
    } while (!dropped.empty());
  }

  void drop_beaten(std::span<const WeighedEdge> edges, std::span<const std::uint32_t> cluster_of, double significance) {
    std::map<Pair, int> balance;  // duels won by the first less those won by the second
    std::map<Pair, int> fought;
    for (const ClusterBond& b : bonds_) {
      if (b.of < b.from && b.contradiction > 0 && stands(b.of) && stands(b.from)) balance[{b.of, b.from}] = 0;
    }
    if (balance.empty()) return;
    std::map<std::uint32_t, std::map<std::uint32_t, std::uint64_t>> at;  // inliers by vertex and cluster
    for (std::size_t e = 0; e < edges.size(); ++e) {
      if (!stands(cluster_of[e])) continue;
      at[to_index(edges[e].u)][cluster_of[e]] += edges[e].weight;
      at[to_index(edges[e].v)][cluster_of[e]] += edges[e].weight;
    }
    for (const auto& [vertex, inliers] : at) {
      for (auto a = inliers.begin(); a != inliers.end(); ++a) {
        for (auto b = std::next(a); b != inliers.end(); ++b) {
          const auto found = balance.find({a->first, b->first});
          if (found == balance.end() || a->second == b->second) continue;
          found->second += a->second > b->second ? 1 : -1;
          ++fought[found->first];
        }
      }
    }
    // A sign test: by chance the balance of n duels has the deviation sqrt(n).
    for (const auto& [pair, won] : balance) {
      if (static_cast<double>(won) * won < significance * significance * fought[pair] || won == 0) continue;
      standings_[won > 0 ? pair.second : pair.first].reason = Reason::kUnsupported;
    }
  }

  std::vector<ClusterStanding> finish(double times) {
    weigh();
    for (std::uint32_t c = 0; c < standings_.size(); ++c) {
      if (stands(c) && outweighed(c, times)) standings_[c].reason = Reason::kAmbiguous;
    }
    return std::move(standings_);
  }

 private:
  bool outweighed(std::uint32_t c, double times) const {
    return static_cast<double>(standings_[c].contradiction) > times * static_cast<double>(standings_[c].support);
  }

  std::span<const ClusterBond> bonds_;
  std::vector<ClusterStanding> standings_;
};

}  // namespace

std::vector<ClusterStanding> contest(std::span<const WeighedEdge> edges, std::span<const std::uint32_t> cluster_of,
                                     const std::vector<bool>& out, std::span<const ClusterBond> bonds,
                                     const ContestOptions& options) {
  Contest contest(bonds, out);
  contest.drop_outweighed(options.dropped_beyond);
  contest.drop_beaten(edges, cluster_of, options.duel_significance);
  return contest.finish(options.ambiguous_beyond);
}

}  // namespace mapweld
