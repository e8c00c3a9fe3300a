#include "core/merge/spectral/connectivity_gain.h"

#include <cmath>
#include <utility>

#include "core/graph/components.h"
#include "core/graph/spectral_embedding.h"

namespace mapweld {

ConnectivityGain::ConnectivityGain(const AppearanceGraph& graph, const Options& options, bool embeds)
    : options_(options), sets_(graph.vertices()), hanging_(graph.vertices()), place_(graph.vertices(), kNowhere) {
  if (graph.vertices() == 0) return;
  for (std::uint32_t v = 0; v < graph.vertices(); ++v) {
    for (const Neighbour& n : graph.neighbours(VertexId{v})) sets_.join(v, to_index(n.vertex));
  }
  const Components components = connected_components(graph);
  const std::vector<VertexId> largest = components.vertices_of(components.largest());
  for (std::uint32_t i = 0; i < largest.size(); ++i) place_[to_index(largest[i])] = i;
  for (std::uint32_t v = 0; v < graph.vertices(); ++v) {
    if (!is_embedded(VertexId{v})) hanging_[sets_.root(v)].push_back(v);
  }
  if (!embeds || largest.size() < 2) {
    coordinates_.setZero(static_cast<Eigen::Index>(largest.size()), 1);
    metric_.inverse.setIdentity(1, 1);
  } else {
    const SpectralEmbedding embedding = components.count() == 1
                                            ? spectral_embedding(graph, options.dimensions)
                                            : spectral_embedding(induced_subgraph(graph, largest), options.dimensions);
    coordinates_ = embedding.vectors;
    metric_.inverse = embedding.values.cwiseInverse().asDiagonal();
  }
  power_up();
  scaled_.reserve(static_cast<std::size_t>(coordinates_.size()));
  for (Eigen::Index i = 0; i < coordinates_.rows(); ++i) {
    for (Eigen::Index k = 0; k < coordinates_.cols(); ++k) {
      scaled_.push_back(static_cast<float>(coordinates_(i, k) * std::sqrt(metric_.powered(k, k))));
    }
  }
}

void ConnectivityGain::power_up() {
  metric_.powered = metric_.inverse;
  for (int i = 1; i < options_.power; ++i) metric_.powered = metric_.powered * metric_.inverse;
}

void ConnectivityGain::add(VertexId u, VertexId v) {
  const std::uint32_t a = component(u), b = component(v);
  if (a == b) {
    if (is_embedded(u)) expect(u, v, 1);
    return;
  }
  std::vector<std::uint32_t> coming = std::move(hanging_[a]);
  coming.insert(coming.end(), hanging_[b].begin(), hanging_[b].end());
  hanging_[a].clear();
  hanging_[b].clear();
  sets_.join(a, b);
  if (is_embedded(u) || is_embedded(v)) {
    const std::uint32_t place = place_[to_index(is_embedded(u) ? u : v)];
    for (const std::uint32_t w : coming) place_[w] = place;
  } else {
    hanging_[sets_.root(a)] = std::move(coming);
  }
}

Eigen::VectorXd ConnectivityGain::difference(VertexId u, VertexId v) const {
  return coordinates_.row(place_[to_index(u)]) - coordinates_.row(place_[to_index(v)]);
}

void ConnectivityGain::expect(VertexId u, VertexId v, double weight) {
  // Sherman & Morrison.
  const Eigen::VectorXd d = difference(u, v);
  const Eigen::VectorXd m = metric_.inverse * d;
  const double scale = weight / (1 + weight * d.dot(m));
  metric_.inverse -= scale * m * m.transpose();
  power_up();
}

double ConnectivityGain::gain(VertexId u, VertexId v) const {
  const Eigen::Index k = coordinates_.cols();
  const double* a = coordinates_.data() + k * place_[to_index(u)];
  const double* b = coordinates_.data() + k * place_[to_index(v)];
  double sum = 0;
  for (Eigen::Index i = 0; i < k; ++i) {
    const double* row = metric_.powered.data() + k * i;
    double dot = 0;
    for (Eigen::Index j = 0; j < k; ++j) dot += row[j] * (a[j] - b[j]);
    sum += dot * (a[i] - b[i]);
  }
  return sum;
}

}  // namespace mapweld
