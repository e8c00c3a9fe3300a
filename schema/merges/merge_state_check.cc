#include "schema/merges/merge_state_check.h"

#include <algorithm>
#include <cstdint>
#include <optional>
#include <string_view>
#include <utility>

#include "schema/merges/merge_state_store.h"

namespace mapweld {
namespace {

using Pair = std::pair<std::uint32_t, std::uint32_t>;  // of vertices, the lesser first

class StateChecker {
 public:
  StateChecker(const Reader& db, const MergeRow& merge, const MergeState& state)
      : db_(db), merge_(merge), state_(state) {}

  std::vector<std::string> run() {
    compare_with_row();
    check_counts();
    check_verdicts();
    return std::move(findings_);
  }

 private:
  void expect(bool holds, std::string what) {
    if (!holds) findings_.push_back(std::move(what));
  }

  void agree(std::string_view what, std::uint64_t in_state, std::uint64_t elsewhere, std::string_view where) {
    expect(in_state == elsewhere, "its state has " + std::to_string(in_state) + " " + std::string(what) + ", " +
                                      std::string(where) + " " + std::to_string(elsewhere));
  }

  void compare_with_row() {
    agree("steps", state_.step, merge_.step, "its row");
    agree("verifications", state_.verifications, merge_.spent.verifications, "its row");
    agree("edges", state_.edges.size(), merge_.spent.edges, "its row");
    expect(state_.method == merge_.method, "its state is one of " + state_.method + ", its row says " + merge_.method);
    expect(to_string(state_.phase) == merge_.phase,
           "its state is in " + std::string(to_string(state_.phase)) + ", its row in " + merge_.phase);
  }

  void check_counts() {
    agree("verifications", state_.verifications, state_.edges.size() + state_.rejected.size(), "and its verdicts are");
    expect(state_.inherited_edges <= state_.edges.size() && state_.inherited_rejected <= state_.rejected.size(),
           "its state took over more verdicts than it has");
    std::uint64_t before = 0;
    for (const MergeEdge& edge : state_.edges) {
      if (edge.verifications <= before || edge.verifications > state_.verifications) {
        findings_.push_back("its edges were not inserted in the order in which they stand: " + text_of(edge.u, edge.v));
        break;
      }
      before = edge.verifications;
    }
  }

  // Every verdict is about two vertices of different members, and each pair has one.
  void check_verdicts() {
    const std::vector<std::int64_t> member_of = members_of_vertices();
    expect(state_.vertices <= member_of.size(), "its state is about " + std::to_string(state_.vertices) +
                                                    " vertices, its members have " + std::to_string(member_of.size()) +
                                                    " below their watermarks");
    std::vector<Pair> judged;
    judged.reserve(state_.edges.size() + state_.rejected.size());
    const auto judge = [&](VertexId u, VertexId v) {
      const Pair pair = std::minmax(to_index(u), to_index(v));
      if (pair.second >= std::min<std::size_t>(state_.vertices, member_of.size())) {
        findings_.push_back("it has a verdict about a vertex that its members do not have: " + text_of(u, v));
      } else if (member_of[pair.first] == member_of[pair.second]) {
        findings_.push_back("it has a verdict about two vertices of one member: " + text_of(u, v));
      } else {
        judged.push_back(pair);
      }
    };
    for (const MergeEdge& edge : state_.edges) judge(edge.u, edge.v);
    for (const RejectedPair& pair : state_.rejected) judge(pair.source, pair.target);
    std::ranges::sort(judged);
    const auto twice = std::ranges::adjacent_find(judged);
    if (twice == judged.end()) return;
    findings_.push_back("it has two verdicts about one pair: " +
                        text_of(VertexId{twice->first}, VertexId{twice->second}));
  }

  std::vector<std::int64_t> members_of_vertices() const {
    std::vector<std::int64_t> member_of;
    sqlite::Statement span = db_.prepare("SELECT member, count FROM member_spans WHERE merged = ? ORDER BY span");
    span.bind(1, merge_.map);
    while (span.step()) {
      member_of.insert(member_of.end(), static_cast<std::size_t>(span.integer(1)), span.integer(0));
    }
    return member_of;
  }

  static std::string text_of(VertexId u, VertexId v) {
    return std::to_string(to_index(u)) + " and " + std::to_string(to_index(v));
  }

  const Reader& db_;
  const MergeRow& merge_;
  const MergeState& state_;
  std::vector<std::string> findings_;
};

}  // namespace

std::vector<std::string> check_merge_state(const Reader& db, const MergeRow& merge) {
  const std::optional<MergeState> state = load_merge_state(db, merge.id);
  if (state) return StateChecker(db, merge, *state).run();
  if (!merge.checkpoint_at) return {};
  return {"it was written, and is not there"};
}

}  // namespace mapweld
