// At which share of all verifications the certificate, and the estimate beside it, become useful (docs/certificate.md):
// both along a merge of two stored maps, with the truth beside.
#include <algorithm>
#include <cstdio>
#include <memory>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>

#include "core/geometry/epipolar_verifier.h"
#include "core/graph/algebraic_connectivity.h"
#include "core/graph/components.h"
#include "core/merge/certificate/outlook.h"
#include "core/merge/make_merger.h"
#include "core/merge/run.h"
#include "tests/benchmark/stored_pair.h"

namespace {

using namespace mapweld;

struct Point {
  double share = 0;  // of all verifications
  Certificate certificate;
  FinalEstimate estimate;
  std::vector<VertexId> component;  // the largest one
  double value = 0;                 // lambda_2 on it
};

void measure(MergeInput input, const std::string& method, int points) {
  input.options.method = method;
  const auto whole = make_merger(input);
  run(*whole, {});
  const std::uint64_t all = whole->state().verifications;
  const auto merger = make_merger(input);
  Outlook outlook;
  std::vector<Point> curve;
  for (int k = 1; k <= points; ++k) {
    run(*merger, stop_at_verifications(all * static_cast<std::uint64_t>(k) / static_cast<std::uint64_t>(points)));
    const LargestComponentConnectivity largest = largest_component_connectivity(merger->graph());
    const auto certificate = outlook.certificate(*merger);
    if (!certificate) continue;
    curve.push_back({static_cast<double>(k) / points, *certificate, *outlook.estimate(*merger), largest.vertices,
                     largest.connectivity.value});
  }
  std::printf("%s: %llu verifications\n  share  certified  estimated  true  could join\n", method.c_str(),
              static_cast<unsigned long long>(all));
  for (const Point& point : curve) {
    const double end = algebraic_connectivity(induced_subgraph(whole->graph(), point.component)).value;
    std::printf("  %4.0f %%  %9.4f  %9.4f  %.4f  %u\n", 100 * point.share, point.certificate.certified_fraction,
                point.estimate.fraction, end > 0 ? point.value / end : 1.0, point.certificate.joinable_vertices);
  }
  const auto reached = [&curve](double level, auto&& fraction) {
    const auto found = std::ranges::find_if(curve, [&](const Point& p) { return fraction(p) >= level; });
    return found == curve.end() ? 100.0 : 100 * found->share;
  };
  const auto certified = [](const Point& p) {
    return p.certificate.joinable_vertices == 0 ? p.certificate.certified_fraction : 0.0;
  };
  const auto estimated = [](const Point& p) { return std::min(p.estimate.fraction, p.estimate.vertices_share); };
  std::printf("  with nobody left to join: certified 50 / 90 %% at %.0f / %.0f %%, estimated at %.0f / %.0f %%\n",
              reached(0.5, certified), reached(0.9, certified), reached(0.5, estimated), reached(0.9, estimated));
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app{"The certificate and the estimate along a merge of two stored maps"};
  std::string data, first = "robot-a", second = "robot-b", cache;
  std::vector<std::string> methods{"quickconnect", "spectral"};
  int points = 50;
  app.add_option("--data", data, "Data folder")->required();
  app.add_option(
         "--maps",
         [&](const std::vector<std::string>& names) {
           first = names.at(0);
           second = names.at(1);
           return true;
         },
         "Two maps")
      ->expected(2);
  app.add_option("--methods", methods);
  app.add_option("--points", points);
  app.add_option("--cache", cache, "Keeps verdicts from run to run");
  CLI11_PARSE(app, argc, argv);
  MergeInput input = benchmark_support::load_stored_pair(data, first, second);
  input.verifier = std::make_shared<benchmark_support::RememberingVerifier>(
      std::make_shared<EpipolarVerifier>(VerifierOptions{}), cache);
  for (const std::string& method : methods) measure(input, method, points);
}
