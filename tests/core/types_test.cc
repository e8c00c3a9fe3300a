#include "core/types.h"

#include <set>
#include <string_view>

#include <gtest/gtest.h>

namespace mapweld {
namespace {

// The last of them: checkpoints are refused beyond it (schema/blobs/merge_state_blob.cc).
constexpr int kLast = static_cast<int>(Reason::kAmbiguous);

TEST(Reason, EveryWordIsItsOwnAndComesBack) {
  std::set<std::string_view> words;
  for (int value = 0; value <= kLast; ++value) {
    const auto reason = static_cast<Reason>(value);
    words.insert(to_string(reason));
    EXPECT_EQ(parse_reason(to_string(reason)), reason);
  }
  EXPECT_EQ(words, (std::set<std::string_view>{"", "too_few_features", "no_candidate", "too_few_inliers",
                                               "not_significant", "inconsistent", "unsupported", "ambiguous"}));
  EXPECT_EQ(to_string(static_cast<Reason>(kLast + 1)), "");
  EXPECT_EQ(parse_reason("Ambiguous"), std::nullopt);
}

TEST(VoteRule, EveryWordComesBack) {
  for (const VoteRule rule : {VoteRule::kMin, VoteRule::kProduct, VoteRule::kSignatures}) {
    EXPECT_NE(to_string(rule), "");
    EXPECT_EQ(parse_vote_rule(to_string(rule)), rule);
  }
  EXPECT_EQ(parse_vote_rule(""), std::nullopt);
}

}  // namespace
}  // namespace mapweld
