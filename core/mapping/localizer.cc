#include "core/mapping/localizer.h"

#include <algorithm>

#include "core/retrieval/voting.h"

namespace mapweld {
namespace {

// How much a reason tells the user: a pair that came further through the verifier explains more.
int progress(Reason reason) {
  switch (reason) {
    case Reason::kInconsistent:
      return 3;
    case Reason::kNotSignificant:
      return 2;
    case Reason::kTooFewInliers:
      return 1;
    default:
      return 0;
  }
}

bool better_match(const LocalizationMatch& a, const LocalizationMatch& b) {
  if (a.verified != b.verified) return a.verified;
  if (a.verified && a.verification.inliers != b.verification.inliers) {
    return a.verification.inliers > b.verification.inliers;
  }
  return a.votes != b.votes ? a.votes > b.votes : a.vertex < b.vertex;
}

bool close_in_map(VertexId u, VertexId v, const MapView& map) {
  const auto [low, high] = std::minmax({to_index(u), to_index(v)});
  return high - low <= static_cast<std::uint32_t>(kSamePlaceHops) || map.hops(u, v, kSamePlaceHops).has_value();
}

// Is there a verified match of another place that the best one is not clearly ahead of? `matches`: best first.
bool has_rival_place(const std::vector<LocalizationMatch>& matches, const MapView& map, const PairVerifier& verifier) {
  const auto unverified = std::ranges::find(matches, false, &LocalizationMatch::verified);
  const int best_inliers = matches.front().verification.inliers;
  std::vector<VertexId> elsewhere;  // not known to be of the best match's place; strongest first
  std::size_t rivals = 0;           // so many of them, from the front, are not clearly behind
  for (auto m = matches.begin() + 1; m != unverified; ++m) {
    rivals += m->verification.inliers * kClearlyAhead >= best_inliers ? 1 : 0;
    elsewhere.push_back(m->vertex);
  }
  std::vector<VertexId> place{matches.front().vertex};
  for (std::size_t i = 0; i < place.size() && rivals > 0; ++i) {
    for (std::size_t k = 0; k < elsewhere.size();) {
      if (!close_in_map(place[i], elsewhere[k], map) &&
          !verifier.verify(*map.appearances(place[i]), *map.appearances(elsewhere[k])).accepted) {
        ++k;
        continue;
      }
      place.push_back(elsewhere[k]);
      elsewhere.erase(elsewhere.begin() + static_cast<std::ptrdiff_t>(k));
      rivals -= k < rivals ? 1 : 0;
    }
  }
  return rivals > 0;
}

}  // namespace

std::string_view to_string(LocalizationStatus status) {
  switch (status) {
    case LocalizationStatus::kLocalized:
      return "localized";
    case LocalizationStatus::kAmbiguous:
      return "ambiguous";
    case LocalizationStatus::kNotFound:
      return "not_found";
  }
  return "";
}

Localization localize(const AppearanceVector& query, const MapView& map, const PairVerifier& verifier,
                      const MapParameters& parameters) {
  Localization result;
  const int needed = std::max(verifier.options().min_inliers, kFewestInliers);
  result.funnel.features = static_cast<int>(query.appearances.size());
  result.funnel.needed_inliers = needed;

  const Votes votes = vote(query, map.postings(), parameters.votes, parameters.min_votes);
  result.funnel.known_words = votes.known_words;
  result.funnel.candidates = static_cast<int>(votes.candidates.size());
  if (result.funnel.features < needed) {
    result.reason = Reason::kTooFewFeatures;
  } else if (votes.candidates.empty()) {
    result.reason = Reason::kNoCandidate;
  }

  result.matches.reserve(votes.candidates.size());
  Reason furthest = Reason::kTooFewInliers;
  for (const VotedVertex& candidate : votes.candidates) {
    LocalizationMatch match{
        .vertex = candidate.vertex, .votes = candidate.votes, .verified = false, .verification = {}};
    if (result.funnel.verified < parameters.verify_top && result.reason == Reason::kNone) {
      match.verification = verifier.verify(query, *map.appearances(candidate.vertex));
      match.verified = match.verification.accepted;
      ++result.funnel.verified;
      result.funnel.best_inliers = std::max(result.funnel.best_inliers, match.verification.inliers);
      if (progress(match.verification.reason) > progress(furthest)) furthest = match.verification.reason;
    }
    result.matches.push_back(std::move(match));
  }
  std::ranges::sort(result.matches, better_match);

  if (result.reason != Reason::kNone) return result;
  if (!result.matches.front().verified) {
    result.reason = furthest;
  } else {
    result.status = has_rival_place(result.matches, map, verifier) ? LocalizationStatus::kAmbiguous
                                                                   : LocalizationStatus::kLocalized;
  }
  return result;
}

}  // namespace mapweld
