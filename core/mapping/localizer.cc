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

bool has_rival_place(const std::vector<LocalizationMatch>& matches, const MapView& map) {
  const LocalizationMatch& best = matches.front();
  for (const LocalizationMatch& m : matches) {
    if (!m.verified || m.verification.inliers * kClearlyAhead < best.verification.inliers) break;
    if (m.vertex != best.vertex && !map.hops(best.vertex, m.vertex, kSamePlaceHops)) return true;
  }
  return false;
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
  const int needed = verifier.options().min_inliers;
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
    result.status =
        has_rival_place(result.matches, map) ? LocalizationStatus::kAmbiguous : LocalizationStatus::kLocalized;
  }
  return result;
}

}  // namespace mapweld
