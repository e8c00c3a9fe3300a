#include "core/guard/beliefs.h"

#include <algorithm>
#include <limits>
#include <queue>
#include <utility>

namespace mapweld {
namespace {

constexpr double kCertain = std::numeric_limits<double>::infinity();

}  // namespace

void Beliefs::add(std::uint32_t u, std::uint32_t v, const EdgeSigns& signs) {
  const std::uint32_t number = size();
  edges_.push_back({u, v, signs, 0});
  edges_.back().signs.fullness_around = signs.fullness;
  at_[u].push_back(number);
  at_[v].push_back(number);
}

template <typename Use>
void Beliefs::for_each_supporter(const LinkLists& links, std::uint32_t e, const Use& use) {
  const std::uint32_t u = edges_[e].u, v = edges_[e].v;
  ++stamp_;
  const auto stand = [&](std::uint32_t vertex, double belief) {
    mark_[vertex] = stamp_;
    along_[vertex] = belief;
  };
  for (const Link& link : links[v]) stand(link.to, link.belief);
  stand(v, kCertain);
  const auto from = [&](std::uint32_t x, double belief) {
    for (const std::uint32_t f : at_[x]) {
      const std::uint32_t other = edges_[f].u == x ? edges_[f].v : edges_[f].u;
      if (f != e && mark_[other] == stamp_) use(f, std::min(belief, along_[other]));
    }
  };
  from(u, kCertain);
  for (const Link& link : links[u]) from(link.to, link.belief);
}

void Beliefs::see_around(std::uint32_t e, std::vector<std::uint32_t>& raised) {
  EdgeSigns& mine = edges_[e].signs;
  for_each_supporter(around_, e, [&](std::uint32_t f, double along) {
    EdgeSigns& other = edges_[f].signs;
    mine.fullness_around = std::max(mine.fullness_around, std::min(other.fullness, along));
    if (const double shown = std::min(mine.fullness, along); other.fullness_around < shown) {
      other.fullness_around = shown;
      raised.push_back(f);
    }
  });
  raised.push_back(e);
}

void Beliefs::settle(bool links_changed) {
  std::vector<std::uint32_t> raised;
  for (std::uint32_t e = settled_; e < size(); ++e) see_around(e, raised);
  for (std::uint32_t e = 0; links_changed && e < settled_; ++e) raised.push_back(e);
  std::ranges::sort(raised);
  raised.erase(std::ranges::unique(raised).begin(), raised.end());

  // Greatest belief first, so that most edges pass theirs on once.
  std::priority_queue<std::pair<double, std::uint32_t>> open;
  for (const std::uint32_t e : raised) {
    const double own = weigh(edges_[e].signs, model_, is_inner_).sum();
    edges_[e].belief = e < settled_ ? std::max(edges_[e].belief, own) : own;
  }
  for (const std::uint32_t e : raised) {
    if (e >= settled_) {
      for_each_supporter(passing_, e, [&](std::uint32_t f, double along) {
        if (f < settled_)
          edges_[e].belief = std::max(edges_[e].belief, std::min(edges_[f].belief, along) - model_.step);
      });
    }
    open.emplace(edges_[e].belief, e);
  }
  settled_ = size();
  while (!open.empty()) {
    const auto [belief, e] = open.top();
    open.pop();
    if (belief < edges_[e].belief) continue;
    for_each_supporter(passing_, e, [&, from = belief](std::uint32_t f, double along) {
      const double passed = std::min(from, along) - model_.step;
      if (edges_[f].belief >= passed) return;
      edges_[f].belief = passed;
      open.emplace(passed, f);
    });
  }
}

}  // namespace mapweld
