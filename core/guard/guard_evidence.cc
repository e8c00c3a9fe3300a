#include "core/guard/guard_evidence.h"

#include <algorithm>
#include <iterator>

namespace mapweld {
namespace {

struct Meaning {
  std::string_view name;
  std::string_view says;
};

constexpr Meaning kMeanings[] = {
    {"rare_matches", "matches on things that either map has near this place only"},
    {"far_images", "images far away that could have had them too: with few, rarity says little"},
    {"common_share", "how much of the images either map shows elsewhere too: where much recurs, rarity says less"},
    {"fullness_around",
     "how much of the view agrees, all over it, here or in an edge beside it; a view seen twice has 2 to 9"},
    {"fullness", "how much of the view agrees, all over it, in this edge"},
    {"inner_fullness", "how fully the maps show a place again by themselves; less than that speaks against"},
    {"nearness", "how nearly as full the edge is as the fullest of its ends: in dense maps, neighbours on the way"},
    {"on_the_way",
     "how much more often than any two images successive ones verify here: a drive, and not a collection"},
    {"neighbours", "what edges between the same two places add"},
    {"prior", "what is asked of any edge"},
};

}  // namespace

std::vector<EvidenceItem> evidence_items(const GuardEvidence& e) {
  return {{"rare_matches", static_cast<double>(e.signs.rare_matches), e.parts.rarity},
          {"far_images", static_cast<double>(e.signs.far_images), std::nullopt},
          {"common_share", e.signs.common_share, std::nullopt},
          {"fullness_around", e.signs.fullness_around, e.parts.fullness},
          {"fullness", e.signs.fullness, std::nullopt},
          {"inner_fullness", e.signs.inner_fullness, e.parts.shortfall},
          {"nearness", e.signs.inner_fullness > 0 ? e.signs.fullness / e.signs.inner_fullness : 0, e.parts.nearness},
          {"on_the_way", e.signs.on_the_way, e.signs.on_the_way},
          {"neighbours", e.neighbours, e.neighbours},
          {"prior", e.parts.prior, e.parts.prior}};
}

std::string_view evidence_says(std::string_view name) {
  const auto* const found = std::ranges::find(kMeanings, name, &Meaning::name);
  return found == std::end(kMeanings) ? std::string_view() : found->says;
}

}  // namespace mapweld
