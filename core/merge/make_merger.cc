#include "core/merge/make_merger.h"

#include <array>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "core/errors.h"
#include "core/merge/merge_options.h"
#include "core/merge/methods/alignment.h"
#include "core/merge/methods/brute_force.h"
#include "core/merge/methods/degree_min.h"
#include "core/merge/methods/quick_connect.h"
#include "core/merge/methods/random_pairs.h"
#include "core/merge/spectral/spectral.h"

namespace mapweld {
namespace {

struct Method {
  std::string_view name;
  bool is_randomised;
  std::unique_ptr<Merger> (*make)(MergeInput);
};

template <typename M>
constexpr Method method(bool is_randomised = false) {
  return {M::kName, is_randomised,
          [](MergeInput input) -> std::unique_ptr<Merger> { return std::make_unique<M>(std::move(input)); }};
}

constexpr bool kRandomised = true;

// All there are, the paper's own first.
constexpr std::array kMethods{method<QuickConnect>(),
                              method<BruteForce>(),
                              method<RandomPairs>(kRandomised),
                              method<RandomCandidates>(kRandomised),
                              method<DegreeMin>(kRandomised),
                              method<Alignment>(),
                              method<Spectral>()};

const Method* find_method(std::string_view name) {
  for (const Method& m : kMethods) {
    if (m.name == name) return &m;
  }
  return nullptr;
}

void check(const MergeInput& input) {
  if (input.members.size() < 2) throw std::invalid_argument("a merge takes two maps or more");
  std::size_t vertices = 0;
  for (const MergeMember& member : input.members) vertices += member.vertices.size();
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

// A fresh state that has the verdicts of one before.
MergeState begin_anew(MergeState state, MergeState before) {
  state.step = before.step;
  state.verifications = before.verifications;
  state.edges = std::move(before.edges);
  state.rejected = std::move(before.rejected);
  state.inherited_edges = state.edges.size();
  state.inherited_rejected = state.rejected.size();
  return state;
}

}  // namespace

const std::vector<std::string_view>& merge_methods() {
  static const std::vector<std::string_view> names = [] {
    std::vector<std::string_view> all;
    for (const Method& m : kMethods) all.push_back(m.name);
    return all;
  }();
  return names;
}

bool is_randomised(std::string_view method) {
  const Method* found = find_method(method);
  return found != nullptr && found->is_randomised;
}

std::unique_ptr<Merger> make_merger(MergeInput input) {
  check(input);
  const Method* method = find_method(input.options.method);
  if (method == nullptr) throw std::invalid_argument("no merge method is called \"" + input.options.method + "\"");
  return method->make(std::move(input));
}

std::unique_ptr<Merger> make_merger(MergeInput input, MergeState state) {
  std::unique_ptr<Merger> merger = make_merger(std::move(input));
  if (state.method != merger->state().method) throw FormatError("a checkpoint of another merge method");
  if (state.input_fingerprint == merger->former_fingerprint_ &&
      state.rules_fingerprint == merger->state().rules_fingerprint) {
    merger->resume(begin_anew(merger->state(), std::move(state)));
    return merger;
  }
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
  merger->resume(begin_anew(merger->state(), std::move(before)));
  return merger;
}

}  // namespace mapweld
