#include "core/graph/approximate_cholesky.h"

#include <algorithm>
#include <random>

namespace mapweld {
namespace {

constexpr int kNone = -1;
constexpr std::uint64_t kSeed = 20160229;

// Vertices by degree, with the least one at hand: a doubly linked list a degree.
class DegreeQueue {
 public:
  DegreeQueue(int vertices, std::size_t degrees) : first_(degrees, kNone), next_(vertices), previous_(vertices) {}

  void insert(int v, std::size_t degree) {
    degree = std::min(degree, first_.size() - 1);
    previous_[v] = kNone;
    next_[v] = first_[degree];
    if (first_[degree] != kNone) previous_[first_[degree]] = v;
    first_[degree] = v;
    least_ = std::min(least_, degree);
  }

  void remove(int v, std::size_t degree) {
    degree = std::min(degree, first_.size() - 1);
    if (previous_[v] == kNone) {
      first_[degree] = next_[v];
    } else {
      next_[previous_[v]] = next_[v];
    }
    if (next_[v] != kNone) previous_[next_[v]] = previous_[v];
  }

  int least() {
    while (first_[least_] == kNone) ++least_;
    return first_[least_];
  }

 private:
  std::vector<int> first_, next_, previous_;
  std::size_t least_ = 0;
};

struct Star {
  int vertex;
  double weight;
  int copies;  // parallel edges that were added up
};

// What is left of the graph: lists that keep entries of eliminated vertices until they are read.
class Remainder {
 public:
  Remainder(int vertices, std::size_t edges) : heads_(vertices, kNone) { links_.reserve(4 * edges); }
  void add(int u, int v, double weight) {
    links_.push_back({v, heads_[u], weight});
    heads_[u] = static_cast<int>(links_.size()) - 1;
  }
  template <typename Visit>
  void visit(int u, const Visit& visit) const {
    for (int k = heads_[u]; k != kNone; k = links_[k].next) visit(links_[k].vertex, links_[k].weight);
  }

 private:
  struct Link {
    int vertex;
    int next;
    double weight;
  };
  std::vector<int> heads_;
  std::vector<Link> links_;
};

}  // namespace

ApproximateCholesky::ApproximateCholesky(int vertices, std::span<const LaplacianEdge> edges) {
  const auto n = static_cast<std::size_t>(vertices);
  Remainder remainder(vertices, edges.size());
  std::vector<std::size_t> degree(n, 0);
  for (const LaplacianEdge& e : edges) {
    remainder.add(e.u, e.v, e.weight);
    remainder.add(e.v, e.u, e.weight);
    ++degree[e.u];
    ++degree[e.v];
  }
  DegreeQueue queue(vertices, n + 1);
  for (int v = vertices - 1; v >= 0; --v) queue.insert(v, degree[v]);

  std::mt19937_64 random(kSeed);
  std::vector<int> slot(n, kNone), position(n, kNone);
  std::vector<Star> star;
  std::vector<double> sums;
  std::vector<std::size_t> old_degree;
  order_.reserve(n);
  pivots_.reserve(n);
  starts_.reserve(n + 1);
  rows_.reserve(edges.size());
  values_.reserve(edges.size());
  for (std::size_t k = 0; k < n; ++k) {
    const int v = queue.least();
    queue.remove(v, degree[v]);
    position[v] = static_cast<int>(k);
    star.clear();
    remainder.visit(v, [&](int u, double weight) {
      if (position[u] != kNone) return;
      if (slot[u] == kNone) {
        slot[u] = static_cast<int>(star.size());
        star.push_back({u, weight, 1});
      } else {
        star[slot[u]].weight += weight;
        ++star[slot[u]].copies;
      }
    });
    std::ranges::sort(star, [](const Star& a, const Star& b) {
      return a.weight != b.weight ? a.weight < b.weight : a.vertex < b.vertex;
    });
    const std::size_t d = star.size();
    sums.assign(d, 0);  // of the weights up to and with each
    old_degree.resize(d);
    double total = 0;
    for (std::size_t i = 0; i < d; ++i) {
      total += star[i].weight;
      sums[i] = total;
      slot[star[i].vertex] = kNone;
      old_degree[i] = degree[star[i].vertex];
      degree[star[i].vertex] -= static_cast<std::size_t>(star[i].copies);
    }
    order_.push_back(v);
    pivots_.push_back(total);
    starts_.push_back(rows_.size());
    for (const Star& s : star) {
      rows_.push_back(s.vertex);
      values_.push_back(s.weight / total);
    }
    for (std::size_t i = 0; i + 1 < d; ++i) {
      const double above = total - sums[i];
      const double drawn = sums[i] + above * (static_cast<double>(random() >> 11) * 0x1p-53);
      const auto found = std::upper_bound(sums.begin() + static_cast<std::ptrdiff_t>(i) + 1, sums.end(), drawn);
      const auto j = std::min(static_cast<std::size_t>(found - sums.begin()), d - 1);
      const double weight = star[i].weight * above / total;
      if (weight <= 0) continue;
      remainder.add(star[i].vertex, star[j].vertex, weight);
      remainder.add(star[j].vertex, star[i].vertex, weight);
      ++degree[star[i].vertex];
      ++degree[star[j].vertex];
    }
    for (std::size_t i = 0; i < d; ++i) {
      const int u = star[i].vertex;
      if (old_degree[i] == degree[u]) continue;
      queue.remove(u, old_degree[i]);
      queue.insert(u, degree[u]);
    }
  }
  starts_.push_back(rows_.size());
  for (int& row : rows_) row = position[row];
}

Eigen::VectorXd ApproximateCholesky::solve(const Eigen::VectorXd& b) const {
  const std::size_t n = order_.size();
  Eigen::VectorXd y(b.size()), x(b.size());
  const double mean = b.mean();
  for (std::size_t k = 0; k < n; ++k) y[static_cast<Eigen::Index>(k)] = b[order_[k]] - mean;
  for (std::size_t k = 0; k < n; ++k) {
    const double value = y[static_cast<Eigen::Index>(k)];
    for (std::size_t i = starts_[k]; i < starts_[k + 1]; ++i) y[rows_[i]] += values_[i] * value;
  }
  for (std::size_t k = n; k-- > 0;) {
    double value = pivots_[k] > 0 ? y[static_cast<Eigen::Index>(k)] / pivots_[k] : 0.0;
    for (std::size_t i = starts_[k]; i < starts_[k + 1]; ++i) value += values_[i] * y[rows_[i]];
    y[static_cast<Eigen::Index>(k)] = value;
  }
  const double level = y.mean();
  for (std::size_t k = 0; k < n; ++k) x[order_[k]] = y[static_cast<Eigen::Index>(k)] - level;
  return x;
}

}  // namespace mapweld
