#include "server/jobs/merge_check.h"

#include <algorithm>
#include <cstdint>
#include <exception>
#include <memory>
#include <optional>

#include "core/retrieval/voting.h"
#include "schema/maps/edge_store.h"
#include "server/jobs/merge_input_loader.h"
#include "server/jobs/merge_job_rows.h"

namespace mapweld::server {
namespace {

constexpr std::uint32_t kMostVotes = 65535;  // that a similarity matrix counts to

// The version of the verifier that gave a merge its verdicts; nothing is known of one without an edge.
std::optional<std::string> verifier_version(const Reader& db, JobId job) {
  const std::vector<EdgeRow> first = list_merge_edges(db, job, 1);
  if (first.empty()) return std::nullopt;
  return load_edge_evidence(db, first.front().id).verifier_version;
}

void recount_votes(const MergeState& state, const MergeInput& input, std::vector<std::string>& findings) {
  for (const MergeEdge& edge : state.edges) {
    const std::uint32_t votes = pair_votes(*input.appearances->appearances(edge.u),
                                           *input.appearances->appearances(edge.v), input.options.votes);
    if (votes == edge.votes || std::min(votes, edge.votes) >= kMostVotes) continue;
    findings.push_back("its edge between " + std::to_string(to_index(edge.u)) + " and " +
                       std::to_string(to_index(edge.v)) + " has " + std::to_string(edge.votes) +
                       " votes, its images give each other " + std::to_string(votes) + "; restart the merge");
  }
}

}  // namespace

MergeCheck check_merge(const Reader& db, const MergeRow& merge, const VerifierFactory& verifier) {
  MergeCheck check;
  if (merge.state == JobState::kCancelled || !merge.checkpoint_at) return check;
  try {
    const std::optional<std::string> version = verifier_version(db, merge.id);
    std::optional<LoadedMerge> loaded = load_merge(db, merge.id, verifier, [] { return false; });
    const std::string present = loaded->input.verifier->version();
    if (version && *version != present) {
      check.notes.push_back("its verdicts are of the verifier " + *version + ", and this program's is " + present +
                            ": it stays as it is, and goes on only when it is restarted");
      return check;
    }
    const std::unique_ptr<Merger> merger = open_merger(*loaded);
    recount_votes(merger->state(), merger->input(), check.findings);
  } catch (const UnusableState& error) {
    check.findings.push_back(std::string("it cannot go on: ") + error.what() + "; restart the merge");
  } catch (const std::exception& error) {
    check.findings.push_back(std::string("it cannot be loaded: ") + error.what());
  }
  return check;
}

}  // namespace mapweld::server
