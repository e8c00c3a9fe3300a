#include "core/merge/merger.h"

#include <algorithm>
#include <bit>
#include <stdexcept>
#include <string>
#include <utility>

#include "core/errors.h"
#include "core/merge/brute_force.h"
#include "core/merge/fingerprint.h"
#include "core/merge/pair_merger.h"
#include "core/merge/quick_connect.h"

namespace mapweld {
namespace {

std::uint32_t vertices_of(const std::vector<MergeMember>& members) {
  std::size_t vertices = 0;
  for (const MergeMember& member : members) vertices += member.vertices.size();
  return static_cast<std::uint32_t>(vertices);
}

void check(const MergeInput& input) {
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

std::uint64_t fingerprint_of(const MergeInput& input) {
  Fingerprint hash;
  hash.add(std::string_view(input.options.method));
  hash.add(input.options.min_votes);
  hash.add(static_cast<std::uint64_t>(input.options.votes));
  hash.add(input.options.seed);
  for (const MergeMember& member : input.members) {
    hash.add(member.vertices.size());
    for (const VertexId v : member.vertices) hash.add(to_index(v));
  }
  hash.add(std::string_view(input.verifier->version()));
  hash.add(static_cast<std::uint64_t>(input.verifier->options().min_inliers));
  hash.add(std::bit_cast<std::uint64_t>(input.verifier->options().max_false_alarms));
  hash.add(input.votes->fingerprint());
  return hash.value();
}

}  // namespace

Merger::Merger(MergeInput input) : input_(std::move(input)), graph_(vertices_of(input_.members), input_.inner_edges) {}

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

PairMerger::PairMerger(MergeInput input) : Merger(std::move(input)) {
  const MemberPair pair = order_members(input_.members);
  m1_ = &input_.members[pair.m1];
  m2_ = &input_.members[pair.m2];
  position_.resize(graph_.vertices());
  for (const MergeMember* member : {m1_, m2_}) {
    for (std::uint32_t i = 0; i < member->vertices.size(); ++i) position_[to_index(member->vertices[i])] = i;
  }
  in_m2_.assign(graph_.vertices(), false);
  for (const VertexId v : m2_->vertices) in_m2_[to_index(v)] = true;
  state_.method = input_.options.method;
  state_.input_fingerprint = fingerprint_of(input_);
  state_.random = input_.options.seed;
}

void PairMerger::resume(MergeState state) {
  const auto fits = [this](VertexId source, VertexId target) {
    return to_index(source) < in_m2_.size() && to_index(target) < in_m2_.size() && in_m2_[to_index(source)] &&
           !in_m2_[to_index(target)];
  };
  const PairSearch& search = state.search;
  bool good = search.pending_next <= search.pending.size() && search.postponed_next <= search.postponed.size() &&
              search.next_row <= votes().rows();
  for (const auto* list : {&search.pending, &search.postponed}) {
    for (const Candidate& c : *list) good = good && fits(c.source, c.target);
  }
  for (const RejectedPair& r : state.rejected) good = good && fits(r.source, r.target);
  if (!good) throw FormatError("a merge state with candidates that its maps cannot have");
  Merger::resume(std::move(state));
}

bool PairMerger::verify(const Candidate& candidate) {
  const VertexId u = std::min(candidate.source, candidate.target), v = std::max(candidate.source, candidate.target);
  Verification verdict =
      input_.verifier->verify(*input_.appearances->appearances(u), *input_.appearances->appearances(v));
  ++state_.verifications;
  if (!verdict.accepted) {
    const auto short_count = [](int count) { return static_cast<std::uint16_t>(std::clamp(count, 0, 65535)); };
    state_.rejected.push_back({candidate.source, candidate.target, verdict.reason, short_count(verdict.matches),
                               short_count(verdict.inliers)});
    return false;
  }
  graph_.add_edge(u, v, static_cast<std::uint32_t>(verdict.inliers));
  const std::uint32_t votes_in_all =
      votes_of_pair(votes(), row(candidate.source), column(candidate.target), input_.options.votes);
  state_.edges.push_back({u, v, votes_in_all, std::move(verdict), state_.verifications});
  return true;
}

const std::vector<std::string_view>& merge_methods() {
  static const std::vector<std::string_view> methods{QuickConnect::kName, BruteForce::kName};
  return methods;
}

std::unique_ptr<Merger> make_merger(MergeInput input) {
  check(input);
  const MemberPair pair = order_members(input.members);
  if (!input.votes) {
    input.votes = std::make_shared<WordVotes>(*input.appearances, input.members[pair.m1], input.members[pair.m2]);
  }
  if (input.options.method == QuickConnect::kName) return std::make_unique<QuickConnect>(std::move(input));
  if (input.options.method == BruteForce::kName) return std::make_unique<BruteForce>(std::move(input));
  throw std::invalid_argument("no merge method is called \"" + input.options.method + "\"");
}

std::unique_ptr<Merger> make_merger(MergeInput input, MergeState state) {
  std::unique_ptr<Merger> merger = make_merger(std::move(input));
  if (state.method != merger->state().method) throw FormatError("a checkpoint of another merge method");
  if (state.input_fingerprint != merger->state().input_fingerprint) {
    throw FormatError("a checkpoint of other maps, other options or another verifier");
  }
  merger->resume(std::move(state));
  return merger;
}

}  // namespace mapweld
