// What a merge is asked to do, apart from how long it may take.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "core/types.h"

namespace mapweld {

struct MergeOptions {
  std::string method = "quickconnect";  // one of merge_methods()
  std::uint32_t min_votes =
      default_min_votes(VoteRule::kSignatures);  // a pair is a candidate when its final votes reach this; 1 .. 65535
  VoteRule votes = VoteRule::kSignatures;        // how the similarity S of two images is counted
  std::uint64_t seed = 0;                        // of the methods that draw at random
  // Of `spectral`: part of the verifications goes to what the certificate's bound rests on (certificate_order.h), so
  // that a budget judged by the certificate ends earlier; the graph gets better more slowly.
  bool serves_certificate = false;
  friend bool operator==(const MergeOptions&, const MergeOptions&) = default;
};

// The names of the methods that can be had, the paper's own first (docs/merging.md, "Methods").
const std::vector<std::string_view>& merge_methods();

// Whether a method draws at random, so that another seed is another order.
bool is_randomised(std::string_view method);

}  // namespace mapweld
