// What the alias guard knows about an edge, and how it is told to others.
//
// The guard's own fields may change with its rule. Whoever stores or shows them takes the list of items instead, and
// knows none of them by name.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/guard/evidence_model.h"

namespace mapweld {

// An edge is confirmed when its confidence is at least this, unless a merge says otherwise.
inline constexpr double kDefaultMinConfidence = 0.9;

// What the guard knows about one edge; for explanations and figures.
struct GuardEvidence {
  EdgeSigns signs;
  EvidenceParts parts;    // what they add to the log odds
  double neighbours = 0;  // what edges around it add: how much more than by its own signs it is believed
  friend bool operator==(const GuardEvidence&, const GuardEvidence&) = default;
};

// One thing that a confidence is made of.
struct EvidenceItem {
  std::string name;                // stable, snake_case, its unit in it
  double value = 0;                // as it was measured
  std::optional<double> log_odds;  // what it adds to the logit of the confidence; none: it is a bar or shown only
  friend bool operator==(const EvidenceItem&, const EvidenceItem&) = default;
};

// All items of an edge, in the order in which people should read them.
std::vector<EvidenceItem> evidence_items(const GuardEvidence& evidence);

// What an item of this name measures, as part of a sentence for people; empty for a name that this program does not
// know (a store may hold items of an older one).
std::string_view evidence_says(std::string_view name);

}  // namespace mapweld
