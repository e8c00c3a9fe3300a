// A state goes on only under the rules that it came from: whatever a verdict depends on, apart from the pair.
#include <functional>
#include <memory>
#include <set>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "core/errors.h"
#include "core/merge/make_merger.h"
#include "core/merge/run.h"
#include "tests/core/merge/toy_maps.h"

namespace mapweld {
namespace {

class OtherVerifier final : public PairVerifier {
 public:
  Verification verify(const AppearanceVector& a, const AppearanceVector& b) const override { return is_.verify(a, b); }
  std::string version() const override { return "hash-2"; }
  const VerifierOptions& options() const override { return is_.options(); }

 private:
  test::HashVerifier is_{0.6};
};

struct Change {
  const char* what;
  std::function<void(MergeInput&)> make;
};

std::vector<Change> changes() {
  const auto verifier = [](const VerifierOptions& options) {
    return [options](MergeInput& input) { input.verifier = std::make_shared<test::HashVerifier>(0.6, options); };
  };
  VerifierOptions inliers, alarms;
  inliers.min_inliers += 1;
  alarms.max_false_alarms /= 2;
  return {{"method", [](MergeInput& input) { input.options.method = "brute-force"; }},
          {"min_votes", [](MergeInput& input) { input.options.min_votes += 1; }},
          {"votes", [](MergeInput& input) { input.options.votes = VoteRule::kProduct; }},
          {"seed", [](MergeInput& input) { input.options.seed += 1; }},
          {"verifier", [](MergeInput& input) { input.verifier = std::make_shared<OtherVerifier>(); }},
          {"min_inliers", verifier(inliers)},
          {"max_false_alarms", verifier(alarms)}};
}

TEST(RulesFingerprint, TellsEveryRuleApart) {
  const MergeInput input = test::make_toy_merge({});
  std::set<std::uint64_t> fingerprints{make_merger(input)->state().rules_fingerprint};
  for (const Change& change : changes()) {
    MergeInput other = input;
    change.make(other);
    EXPECT_TRUE(fingerprints.insert(make_merger(other)->state().rules_fingerprint).second) << change.what;
  }
}

TEST(RulesFingerprint, AStateOfOtherRulesIsRefused) {
  const MergeInput input = test::make_toy_merge({});
  const auto merger = make_merger(input);
  run(*merger, stop_at_verifications(5));
  const MergeState state = merger->state();
  EXPECT_NO_THROW(make_merger(input, state));
  EXPECT_NO_THROW(make_grown_merger(input, state));
  for (const Change& change : changes()) {
    MergeInput other = input;
    change.make(other);
    EXPECT_THROW(make_merger(other, state), FormatError) << change.what;
    EXPECT_THROW(make_grown_merger(other, state), FormatError) << change.what;
  }
}

}  // namespace
}  // namespace mapweld
