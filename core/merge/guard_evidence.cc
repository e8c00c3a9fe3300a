#include "core/merge/guard_evidence.h"

#include <algorithm>
#include <iterator>

namespace mapweld {
namespace {

struct Meaning {
  std::string_view name;
  std::string_view says;
};

constexpr Meaning kMeanings[] = {
    {"fullness", "how much of the view the two images share, all over it; a view seen twice has 4 to 9"},
    {"rare_matches", "matches on things that either map has near this place only"},
    {"matched_share", "of the features in the common view, so many match"},
    {"shared_view", "of an image, so much is in the common view"},
    {"spread_diagonals", "how far the matches spread over the image"},
    {"cluster_edges", "verified edges around this one that join the same two places"},
    {"support", "weight of the edges around it that agree"},
    {"contradiction", "weight of the edges that say that one of the two images is elsewhere"},
};

}  // namespace

std::vector<EvidenceItem> evidence_items(const GuardEvidence& evidence) {
  const auto item = [](const char* name, auto value) {
    return EvidenceItem{name, static_cast<double>(value), std::nullopt};
  };
  return {item("fullness", evidence.fullness),
          item("rare_matches", evidence.rare_matches),
          item("matched_share", evidence.matched_share),
          item("shared_view", evidence.shared_view),
          item("spread_diagonals", evidence.spread),
          item("cluster_edges", evidence.cluster_edges),
          item("support", evidence.support),
          item("contradiction", evidence.contradiction)};
}

std::string_view evidence_says(std::string_view name) {
  const auto* const found = std::ranges::find(kMeanings, name, &Meaning::name);
  return found == std::end(kMeanings) ? std::string_view() : found->says;
}

}  // namespace mapweld
