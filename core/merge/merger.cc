#include "core/merge/merger.h"

#include <stdexcept>
#include <string>
#include <utility>

#include "core/errors.h"
#include "core/merge/alignment.h"
#include "core/merge/brute_force.h"
#include "core/merge/degree_min.h"
#include "core/merge/quick_connect.h"
#include "core/merge/random_pairs.h"
#include "core/merge/spectral.h"

namespace mapweld {
namespace {

std::uint32_t vertices_of(const std::vector<MergeMember>& members) {
  std::size_t vertices = 0;
  for (const MergeMember& member : members) vertices += member.vertices.size();
  return static_cast<std::uint32_t>(vertices);
}

void check(const MergeInput& input) {
  if (input.members.size() < 2) throw std::invalid_argument("a merge takes two maps or more");
  const std::uint32_t vertices = vertices_of(input.members);
  std::vector<bool> taken(vertices, false);
  for (const MergeMember& member : input.members) {
    for (const VertexId v : member.vertices) {
      if (to_index(v) >= vertices || taken[to_index(v)]) {
        throw std::invalid_argument("members must number the merged vertices from 0, each once");
      }
      taken[to_index(v)] = true;
    }
  }
  if (input.options.min_votes < 1 || input.options.min_votes > 65535) {
    throw std::invalid_argument("min_votes must be between 1 and 65535");
  }
  if (!input.appearances || !input.verifier) throw std::invalid_argument("a merge needs appearances and a verifier");
}

}  // namespace

Merger::Merger(MergeInput input) : input_(std::move(input)), graph_(vertices_of(input_.members), input_.inner_edges) {
  state_.vertices = graph_.vertices();
}

std::vector<bool> Merger::finished_pairs() const {
  const std::size_t members = input_.members.size();
  return std::vector<bool>(members * (members - 1) / 2, done());
}

void Merger::resume(MergeState state) {
  if (state.verifications != state.edges.size() + state.rejected.size()) {
    throw FormatError("a merge state whose verdicts do not add up");
  }
  for (const MergeEdge& e : state.edges) {
    const bool fits = e.u < e.v && to_index(e.v) < graph_.vertices() &&
                      graph_.add_edge(e.u, e.v, static_cast<std::uint32_t>(e.verification.inliers));
    if (!fits) throw FormatError("a merge state with an edge that its maps cannot have");
  }
  state_ = std::move(state);
}

const std::vector<std::string_view>& merge_methods() {
  static const std::vector<std::string_view> methods{QuickConnect::kName,     BruteForce::kName, RandomPairs::kName,
                                                     RandomCandidates::kName, DegreeMin::kName,  Alignment::kName,
                                                     Spectral::kName};
  return methods;
}

bool is_randomised(std::string_view method) {
  return method == RandomPairs::kName || method == RandomCandidates::kName || method == DegreeMin::kName;
}

std::unique_ptr<Merger> make_merger(MergeInput input) {
  check(input);
  const std::string method = input.options.method;
  if (method == QuickConnect::kName) return std::make_unique<QuickConnect>(std::move(input));
  if (method == BruteForce::kName) return std::make_unique<BruteForce>(std::move(input));
  if (method == RandomPairs::kName) return std::make_unique<RandomPairs>(std::move(input));
  if (method == RandomCandidates::kName) return std::make_unique<RandomCandidates>(std::move(input));
  if (method == Alignment::kName) return std::make_unique<Alignment>(std::move(input));
  if (method == Spectral::kName) return std::make_unique<Spectral>(std::move(input));
  if (method == DegreeMin::kName) return std::make_unique<DegreeMin>(std::move(input));
  throw std::invalid_argument("no merge method is called \"" + method + "\"");
}

std::unique_ptr<Merger> make_merger(MergeInput input, MergeState state) {
  std::unique_ptr<Merger> merger = make_merger(std::move(input));
  if (state.method != merger->state().method) throw FormatError("a checkpoint of another merge method");
  if (state.input_fingerprint != merger->state().input_fingerprint ||
      state.rules_fingerprint != merger->state().rules_fingerprint) {
    throw FormatError("a checkpoint of other maps, other options or another verifier");
  }
  merger->resume(std::move(state));
  return merger;
}

std::unique_ptr<Merger> make_grown_merger(MergeInput input, MergeState before) {
  std::unique_ptr<Merger> merger = make_merger(std::move(input));
  if (before.vertices > merger->state().vertices) throw FormatError("a checkpoint of larger maps");
  if (before.rules_fingerprint != merger->state().rules_fingerprint) {
    throw FormatError("a checkpoint of another method, other options or another verifier");
  }
  MergeState state = merger->state();
  state.step = before.step;
  state.verifications = before.verifications;
  state.edges = std::move(before.edges);
  state.rejected = std::move(before.rejected);
  state.inherited_edges = state.edges.size();
  state.inherited_rejected = state.rejected.size();
  merger->resume(std::move(state));
  return merger;
}

}  // namespace mapweld
