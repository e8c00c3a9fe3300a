#include "server/jobs/merge_job_rows.h"

#include <algorithm>
#include <utility>

#include <nlohmann/json.hpp>

namespace mapweld::server {
namespace {

using Json = nlohmann::json;

template <typename Read>
auto read_row(const MergeRow& row, const Read& read) {
  try {
    return read();
  } catch (const std::exception& error) {
    throw StoreError(StoreErrorKind::kCorrupt,
                     "the row of merge " + std::to_string(to_index(row.id)) + " does not make sense: " + error.what());
  }
}

template <typename Read>
auto read_json(const MergeRow& row, const std::string& text, const Read& read) {
  return read_row(row, [&] { return read(Json::parse(text)); });
}

template <typename Limit, typename Spending>
std::optional<Limit> left_of(const std::optional<Limit>& allowance, Spending granted_at, Spending spent) {
  if (!allowance) return std::nullopt;
  const auto used = static_cast<Limit>(spent - std::min(spent, granted_at));
  return *allowance - std::min(*allowance, used);
}

double seconds_between(Timestamp from, Timestamp to) { return std::chrono::duration<double>(to - from).count(); }

}  // namespace

std::string to_row(const MergeParameters& parameters) {
  return Json{{"min_votes", parameters.min_votes},
              {"min_inliers", parameters.min_inliers},
              {"max_false_alarms", parameters.max_false_alarms},
              {"votes", to_string(parameters.votes)},
              {"alias_guard", parameters.alias_guard},
              {"min_confidence", parameters.min_confidence},
              {"serves_certificate", parameters.serves_certificate}}
      .dump();
}

std::string to_row(const MergeBudget& budget) { return contract::dump(contract::Json(budget)); }

std::string to_row(const VerifierOptions& options) {
  return Json{{"min_inliers", options.min_inliers}, {"max_false_alarms", options.max_false_alarms}}.dump();
}

std::string to_row(const MergeProgress& progress) {
  Json json{{"words_done", progress.words_done},
            {"words_total", progress.words_total},
            {"candidates_known", progress.candidates_known},
            {"confirmed", progress.confirmed},
            {"revoked", progress.revoked},
            {"components", progress.metrics.components},
            {"algebraic_connectivity", progress.metrics.algebraic_connectivity},
            {"largest_vertices", progress.metrics.largest_vertices},
            {"largest_algebraic_connectivity", progress.metrics.largest_algebraic_connectivity},
            {"joined", progress.metrics.joined},
            {"independent_joins", progress.metrics.independent_joins},
            {"members", Json::array()}};
  if (progress.certified) {
    json["certified_fraction"] = progress.certified->certified_fraction;
    json["estimated_fraction"] = progress.certified->estimated_fraction;
    json["joinable_vertices"] = progress.certified->joinable_vertices;
  }
  for (const MemberPairSummary& p : progress.members) {
    json["members"].push_back(Json::array(
        {p.first, p.second, p.verified, p.accepted, p.confirmed, p.independent_joins, static_cast<int>(p.verdict)}));
  }
  return json.dump();
}

MergeParameters parameters_of(const MergeRow& row) {
  return read_json(row, row.parameters, [](const Json& json) {
    MergeParameters p;
    p.min_inliers = json.value("min_inliers", p.min_inliers);
    p.max_false_alarms = json.value("max_false_alarms", p.max_false_alarms);
    // A row of before there were signatures names "min".
    p.votes = parse_vote_rule(json.value("votes", "min")).value_or(VoteRule::kMin);
    p.min_votes = json.value("min_votes", default_min_votes(p.votes));
    p.alias_guard = json.value("alias_guard", p.alias_guard);
    p.min_confidence = json.value("min_confidence", p.min_confidence);
    p.serves_certificate = json.value("serves_certificate", p.serves_certificate);
    return p;
  });
}

MergeBudget budget_of(const MergeRow& row) {
  return read_row(row, [&row] { return contract::parse_json(row.budget).get<MergeBudget>(); });
}

MergeBudget remaining_of(const MergeRow& row, const Spent& spent) {
  MergeBudget left = budget_of(row);
  left.seconds = left_of(left.seconds, row.granted_at.elapsed_s, spent.elapsed_s);
  left.verifications = left_of(left.verifications, row.granted_at.verifications, spent.verifications);
  left.edges = left_of(left.edges, row.granted_at.edges, spent.edges);
  return left;
}

MergeProgress progress_of(const MergeRow& row) {
  MergeProgress progress = read_json(row, row.progress, [&row](const Json& json) {
    MergeProgress p;
    p.words_done = json.value("words_done", std::uint64_t{0});
    p.words_total = json.value("words_total", std::uint64_t{0});
    p.candidates_known = json.value("candidates_known", std::uint64_t{0});
    p.confirmed = json.value("confirmed", row.spent.edges);
    p.revoked = json.value("revoked", std::uint64_t{0});
    p.metrics.components = json.value("components", std::uint32_t{0});
    p.metrics.algebraic_connectivity = json.value("algebraic_connectivity", 0.0);
    p.metrics.largest_vertices = json.value("largest_vertices", std::uint32_t{0});
    p.metrics.largest_algebraic_connectivity = json.value("largest_algebraic_connectivity", 0.0);
    p.metrics.joined = json.value("joined", std::vector<std::uint32_t>{});
    p.metrics.independent_joins = json.value("independent_joins", std::uint32_t{0});
    if (json.contains("certified_fraction")) {
      p.certified =
          Certified{json.at("certified_fraction"), json.at("estimated_fraction"), json.at("joinable_vertices")};
    }
    for (const Json& pair : json.value("members", Json::array())) {
      p.members.push_back({pair.at(0), pair.at(1), pair.at(2), pair.at(3), pair.at(4), pair.at(5),
                           static_cast<JoinVerdict>(pair.at(6).get<int>())});
    }
    return p;
  });
  progress.phase = row.phase;
  progress.step = row.step;
  progress.verifications = row.spent.verifications;
  progress.edges = row.spent.edges;
  progress.elapsed_s = row.spent.elapsed_s;
  return progress;
}

MergeStatus status_of(const MergeRow& row, const std::vector<MemberRow>& members,
                      const std::optional<MergeProgress>& live, Timestamp now) {
  const MergeProgress progress = live ? *live : progress_of(row);
  MergeStatus status;
  status.id = to_index(row.id);
  status.state = row.state;
  status.method = row.method;
  for (const MemberRow& member : members) status.maps.push_back(member.name);
  status.map = row.map_name;
  status.seed = row.seed;
  status.parameters = parameters_of(row);
  status.phase = progress.phase;
  status.step = progress.step;
  status.words = {progress.words_done, progress.words_total};
  status.candidates = {progress.candidates_known, progress.verifications, progress.edges};
  status.edges = progress.edges;
  status.confirmed_edges = progress.confirmed;
  status.revoked = progress.revoked;
  status.components = progress.metrics.components;
  status.algebraic_connectivity = progress.metrics.algebraic_connectivity;
  status.largest_component = {progress.metrics.largest_vertices, progress.metrics.largest_algebraic_connectivity};
  for (std::size_t k = 0; k < members.size(); ++k) {
    const std::uint64_t joined = k < progress.metrics.joined.size() ? progress.metrics.joined[k] : 0;
    status.joined.push_back({members[k].name, joined});
  }
  status.independent_joins = progress.metrics.independent_joins;
  if (progress.certified) {
    status.certified_fraction = progress.certified->certified_fraction;
    status.estimated_fraction = progress.certified->estimated_fraction;
    status.joinable_vertices = progress.certified->joinable_vertices;
  }
  for (const MemberPairSummary& pair : progress.members) {
    if (std::max(pair.first, pair.second) >= members.size()) continue;
    status.pairs.push_back({members[pair.first].name, members[pair.second].name, pair});
  }
  status.elapsed_s = progress.elapsed_s;
  status.budget = budget_of(row);
  status.remaining = remaining_of(row, {progress.elapsed_s, progress.verifications, progress.edges});
  if (row.state == JobState::kRunning) status.eta_s = progress.eta_s;
  if (live && live->checkpoint_step) {
    const std::chrono::duration<double> age = std::chrono::steady_clock::now() - live->checkpoint_at;
    status.checkpoint = {*live->checkpoint_step, age.count()};
  } else if (row.checkpoint_at) {
    status.checkpoint = {row.step, std::max(0.0, seconds_between(*row.checkpoint_at, now))};
  }
  status.stop_reason = progress.waits_for_space ? std::optional<std::string>("no_space") : row.stop_reason;
  status.error = row.error;
  status.created_at = row.created_at;
  return status;
}

}  // namespace mapweld::server
