#include "core/guard/guard_evidence.h"

#include <algorithm>
#include <set>
#include <string>

#include <gtest/gtest.h>

namespace mapweld {
namespace {

TEST(GuardEvidence, EveryItemHasANameOfItsOwnAndSaysWhatItIs) {
  GuardEvidence evidence;
  evidence.signs.fullness = 4.5;
  evidence.signs.rare_matches = 31;
  evidence.parts = {-3.5, 6, 0, -0.5};
  evidence.neighbours = 1;
  const std::vector<EvidenceItem> items = evidence_items(evidence);
  std::set<std::string> names;
  for (const EvidenceItem& item : items) {
    EXPECT_TRUE(names.insert(item.name).second) << item.name;
    EXPECT_TRUE(std::ranges::all_of(item.name, [](char c) { return (c >= 'a' && c <= 'z') || c == '_'; })) << item.name;
    EXPECT_FALSE(evidence_says(item.name).empty()) << item.name;
  }
  const auto value = [&](const char* name) { return std::ranges::find(items, name, &EvidenceItem::name)->value; };
  EXPECT_EQ(value("fullness"), 4.5);
  EXPECT_EQ(value("rare_matches"), 31);
  double log_odds = 0;
  for (const EvidenceItem& item : items) log_odds += item.log_odds.value_or(0);
  EXPECT_EQ(log_odds, 3) << "the items are the whole";
  EXPECT_EQ(evidence_says("of_yesterday"), "");
}

}  // namespace
}  // namespace mapweld
