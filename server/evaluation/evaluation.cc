#include "server/evaluation/evaluation.h"

#include <algorithm>
#include <array>
#include <chrono>
#include <map>
#include <mutex>
#include <set>
#include <stdexcept>
#include <utility>

#include "core/guard/alias_guard.h"
#include "core/merge/vote_source.h"
#include "server/evaluation/parallel.h"

namespace mapweld::server::evaluation {
namespace {

constexpr std::array<CostAxis, 3> kAxes{CostAxis::kTime, CostAxis::kVerifications, CostAxis::kModelledTime};

std::vector<std::string> methods_to_run(const EvaluationOptions& options) {
  std::vector<std::string> methods = options.methods;
  if (methods.empty()) {
    for (const std::string_view method : merge_methods()) methods.emplace_back(method);
  }
  for (const std::string& method : methods) {
    if (std::ranges::find(merge_methods(), method) == merge_methods().end()) {
      throw std::invalid_argument("no merge method is called \"" + method + "\"");
    }
  }
  if (std::ranges::find(methods, kBaseline) == methods.end()) methods.emplace_back(kBaseline);
  return methods;
}

std::string stage_of(const std::string& method, std::uint32_t run, std::uint32_t runs) {
  return runs == 1 ? method : method + ", run " + std::to_string(run + 1) + " of " + std::to_string(runs);
}

// Every edge that any run found, by its ends.
std::vector<RecordedEdge> union_of_edges(const std::vector<MethodResult>& methods) {
  std::map<std::pair<VertexId, VertexId>, RecordedEdge> edges;
  for (const MethodResult& method : methods) {
    for (const RecordedRun& run : method.runs) {
      for (const RecordedEdge& e : run.edges) edges.try_emplace({e.u, e.v}, e);
    }
  }
  std::vector<RecordedEdge> all;
  for (auto& [ends, edge] : edges) {
    edge.cost = {};
    all.push_back(edge);
  }
  return all;
}

template <typename Value>
Summary summary_over(std::size_t count, const Value& value) {
  std::vector<double> values;
  for (std::size_t i = 0; i < count; ++i) values.push_back(value(i));
  return summary_of(values);
}

LevelCost level_cost(MethodResult& method, std::vector<RunCurve>& curves, double level, double verifier_s) {
  LevelCost result{.level = level};
  std::vector<double> verifications, time_s, modelled_time_s, edges, joined, joins;
  for (std::size_t i = 0; i < curves.size(); ++i) {
    const auto reached = curves[i].edges_to(level);
    if (!reached) continue;
    ++result.reached;
    const Cost cost = cost_of(method.runs[i], *reached);
    verifications.push_back(on_axis(cost, CostAxis::kVerifications, verifier_s));
    time_s.push_back(on_axis(cost, CostAxis::kTime, verifier_s));
    modelled_time_s.push_back(on_axis(cost, CostAxis::kModelledTime, verifier_s));
    edges.push_back(static_cast<double>(*reached));
    joined.push_back(curves[i].at(*reached).joined_vertices);
    joins.push_back(curves[i].at(*reached).independent_joins);
  }
  result.verifications = summary_of(verifications);
  result.time_s = summary_of(time_s);
  result.modelled_time_s = summary_of(modelled_time_s);
  result.edges = summary_of(edges);
  result.joined_vertices = summary_of(joined);
  result.independent_joins = summary_of(joins);
  return result;
}

QualityAtShare quality_at(const MethodResult& method, std::vector<RunCurve>& curves, CostAxis axis, double budget,
                          double final_connectivity, double verifier_s) {
  QualityAtShare quality{.axis = axis, .budget = budget};
  std::vector<double> connectivity, joined, joins;
  for (std::size_t i = 0; i < curves.size(); ++i) {
    const CurvePoint& point = curves[i].at(edges_within(method.runs[i], axis, verifier_s, budget));
    connectivity.push_back(final_connectivity > 0 ? point.connectivity / final_connectivity : 0);
    joined.push_back(point.joined_vertices);
    joins.push_back(point.independent_joins);
  }
  quality.connectivity = summary_of(connectivity);
  quality.joined_vertices = summary_of(joined);
  quality.independent_joins = summary_of(joins);
  return quality;
}

// Judges the edges of the finished merge, which `verified` has with their verifications.
void judge_edges(const MergeInput& input, const std::vector<MergeEdge>& verified, Evaluation& evaluation) {
  const auto verdicts = guard_edges(input.members, evaluation.options.inner_edges, verified, *input.appearances,
                                    {.min_confidence = evaluation.options.min_confidence, .model = {}});
  std::map<std::pair<VertexId, VertexId>, const GuardVerdict*> by_ends;
  for (std::size_t e = 0; e < verified.size(); ++e) by_ends[{verified[e].u, verified[e].v}] = &verdicts[e];
  evaluation.confirmed_edges = 0;
  for (RecordedEdge& edge : evaluation.all_edges) {
    const GuardVerdict& verdict = *by_ends.at({edge.u, edge.v});
    edge.confidence = verdict.confidence;
    edge.confirmed = verdict.confirmed();
    *evaluation.confirmed_edges += edge.confirmed ? 1 : 0;
  }
}

// Leaves the runs the edges that count.
void keep_counted(const std::vector<RecordedEdge>& counted, std::vector<MethodResult>& methods) {
  std::set<std::pair<VertexId, VertexId>> ends;
  for (const RecordedEdge& edge : counted) ends.emplace(edge.u, edge.v);
  for (MethodResult& method : methods) {
    for (RecordedRun& run : method.runs) {
      std::erase_if(run.edges, [&](const RecordedEdge& edge) { return !ends.contains({edge.u, edge.v}); });
    }
  }
}

// `finished` becomes the last state of the baseline, which verifies every candidate.
void run_methods(const MergeInput& input, Evaluation& evaluation, MergeState& finished,
                 const EvaluationObserver& observer) {
  const EvaluationOptions& options = evaluation.options;
  for (const std::string& name : options.methods) {
    MethodResult& method = evaluation.methods.emplace_back();
    method.method = name;
    const std::uint32_t runs = is_randomised(name) ? std::max(1u, options.runs) : 1;
    for (std::uint32_t run = 0; run < runs; ++run) {
      MergeInput of_run = input;
      of_run.options.method = name;
      of_run.options.seed = options.seed + run;
      const auto progress = [&](std::uint64_t verifications) {
        if (observer) observer({stage_of(name, run, runs), verifications, evaluation.candidates});
      };
      method.runs.push_back(record_run(std::move(of_run), progress, name == kBaseline ? &finished : nullptr));
    }
  }
}

void summarise(Evaluation& evaluation, const FinalComponent& component, const EvaluationObserver& observer) {
  const EvaluationOptions& options = evaluation.options;
  const double verifier_s = options.modelled_verifier_s;
  const Cost baseline = evaluation.find(kBaseline)->runs.front().cost;
  std::vector<std::vector<RunCurve>> curves(evaluation.methods.size());
  std::vector<std::pair<std::size_t, std::size_t>> work;
  for (std::size_t m = 0; m < evaluation.methods.size(); ++m) {
    evaluation.methods[m].curves.resize(evaluation.methods[m].runs.size());
    for (std::size_t i = 0; i < evaluation.methods[m].runs.size(); ++i) {
      curves[m].emplace_back(component, evaluation.methods[m].runs[i]);
      work.emplace_back(m, i);
    }
  }
  std::mutex mutex;
  std::uint64_t done = 0;
  parallel_for(work.size(), options.threads, [&](std::size_t w) {
    const auto [m, i] = work[w];
    const RecordedRun& run = evaluation.methods[m].runs[i];
    RunCurve& curve = curves[m][i];
    curve.points(options.curve_points);
    for (const double level : options.levels) curve.edges_to(level);
    for (const CostAxis axis : kAxes) {
      curve.at(edges_within(run, axis, verifier_s, options.share_of_baseline * on_axis(baseline, axis, verifier_s)));
    }
    evaluation.methods[m].curves[i] = curve.points(options.curve_points);
    const std::lock_guard lock(mutex);
    if (observer) observer({"eigenvalues", ++done, work.size()});
  });
  for (std::size_t m = 0; m < evaluation.methods.size(); ++m) {
    MethodResult& method = evaluation.methods[m];
    for (const double level : options.levels) {
      method.levels.push_back(level_cost(method, curves[m], level, verifier_s));
    }
    for (const CostAxis axis : kAxes) {
      method.at_share.push_back(quality_at(method, curves[m], axis,
                                           options.share_of_baseline * on_axis(baseline, axis, verifier_s),
                                           evaluation.final_connectivity, verifier_s));
    }
    const auto total = [&](CostAxis axis) {
      return summary_over(method.runs.size(),
                          [&](std::size_t i) { return on_axis(method.runs[i].cost, axis, verifier_s); });
    };
    method.verifications = total(CostAxis::kVerifications);
    method.time_s = total(CostAxis::kTime);
    method.modelled_time_s = total(CostAxis::kModelledTime);
    for (const RecordedRun& run : method.runs) {
      method.is_complete = method.is_complete && run.edges.size() == evaluation.finished.edges;
    }
  }
}

}  // namespace

const MethodResult* Evaluation::find(std::string_view method) const {
  const auto found = std::ranges::find(methods, method, &MethodResult::method);
  return found == methods.end() ? nullptr : &*found;
}

std::vector<RecordedEdge> Evaluation::counted_edges() const {
  std::vector<RecordedEdge> counted = all_edges;
  if (options.confirmed) std::erase_if(counted, [](const RecordedEdge& edge) { return !edge.confirmed; });
  return counted;
}

std::vector<Edge> confirmed_inner_edges(const MergeInput& input, std::span<const VerifiedEdge> inner_edges,
                                        double min_confidence) {
  const AliasGuard guard(input.members, inner_edges, *input.appearances,
                         {.min_confidence = min_confidence, .model = {}});
  return confirmed_edges(inner_edges, guard.inner_verdicts());
}

Evaluation evaluate(MergeInput input, const EvaluationOptions& options, const EvaluationObserver& observer) {
  if (options.confirmed && !options.guard) throw std::invalid_argument("edges are confirmed by the guard only");
  Evaluation evaluation;
  evaluation.options = options;
  evaluation.options.methods = methods_to_run(options);
  for (const MergeMember& member : input.members) {
    evaluation.member_vertices.push_back(static_cast<std::uint32_t>(member.vertices.size()));
  }
  evaluation.inner_edges = input.inner_edges.size();
  if (!input.votes) {
    const auto begin = std::chrono::steady_clock::now();
    const MemberPair pair = order_members(input.members);
    input.votes = std::make_shared<WordVotes>(*input.appearances, input.members[pair.m1], input.members[pair.m2]);
    evaluation.index_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  }
  evaluation.candidates = count_candidates(*input.votes, input.options.votes, input.options.min_votes);
  MergeState finished_state;
  run_methods(input, evaluation, finished_state, observer);

  evaluation.all_edges = union_of_edges(evaluation.methods);
  if (options.guard) judge_edges(input, finished_state.edges, evaluation);
  const std::vector<RecordedEdge> counted = evaluation.counted_edges();
  if (options.confirmed) keep_counted(counted, evaluation.methods);
  const FinalComponent component(input, counted);
  evaluation.components = component.components();
  evaluation.final_vertices = component.vertices();
  evaluation.final_connectivity = component.final_connectivity();
  RecordedRun finished;
  finished.edges = counted;
  evaluation.finished = RunCurve(component, finished).at(finished.edges.size());
  evaluation.limit = limit_of(
      component, counted, {.levels = options.levels, .curve_points = options.curve_points, .threads = options.threads},
      [&](std::uint64_t done, std::uint64_t total) {
        if (observer) observer({"limit", done, total});
      });
  summarise(evaluation, component, observer);
  return evaluation;
}

}  // namespace mapweld::server::evaluation
