// Small random maps and a verifier without geometry, for the tests of merging.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "core/merge/merge_input.h"
#include "core/types.h"

namespace mapweld::test {

struct ToyWorld {
  std::vector<std::uint32_t> sizes{14, 9};  // vertices of each member
  std::uint32_t places = 12;                // images are taken at random places; each place has words of its own
  std::uint32_t words_per_place = 10;
  std::uint32_t words_per_image = 16;  // drawn with repetition: some words appear several times
  std::uint32_t common_words = 20;     // and from words that are everywhere
  double accept_share = 0.6;           // of pairs that the verifier accepts
  std::uint32_t min_votes = 4;
  VoteRule votes = VoteRule::kMin;  // kSignatures: features have signatures, but in every sixth image
  std::string method = "quickconnect";
  std::uint32_t seed = 1;
};

// Inner edges link each image to a few earlier ones. An image's width_px is its merged number + 1: the verifier's only
// way to know it.
MergeInput make_toy_merge(const ToyWorld& world);

// Worlds of many shapes, one a seed: either map the larger, both of one size, an empty one; all vote rules; strict and
// lenient verifiers.
ToyWorld toy_world(std::uint32_t seed);

// Larger: members of 40 and 30 images, of whose candidates two in five pass.
ToyWorld large_toy_world(std::uint32_t seed, std::string_view method);

// Three to five members, one of them empty for some seeds.
ToyWorld toy_world_of_several(std::uint32_t seed);
// Two robots walk along the same places, one after the other; only nearby places look alike, and the verifier passes
// some pairs that it should not.
ToyWorld long_toy_world(std::uint32_t seed);

// A pure function of the pair: a hash of the two widths decides, and gives inliers, false alarms and matches.
class HashVerifier final : public PairVerifier {
 public:
  explicit HashVerifier(double accept_share, const VerifierOptions& options = {})
      : accept_share_(accept_share), options_(options) {}
  Verification verify(const AppearanceVector& a, const AppearanceVector& b) const override;
  std::string version() const override { return "hash-1"; }
  const VerifierOptions& options() const override { return options_; }

 private:
  double accept_share_;
  VerifierOptions options_;
};

}  // namespace mapweld::test
