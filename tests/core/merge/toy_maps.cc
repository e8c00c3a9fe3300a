#include "tests/core/merge/toy_maps.h"

#include <algorithm>
#include <random>
#include <utility>

#include "core/random.h"
#include "tests/core/retrieval/random_images.h"

namespace mapweld::test {

MergeInput make_toy_merge(const ToyWorld& world) {
  std::mt19937 random(world.seed), signatures(world.seed + 1);
  const auto below = [&random](std::uint32_t n) { return static_cast<std::uint32_t>(random() % n); };
  MergeInput input;
  input.members = number_members(world.sizes);
  std::vector<std::shared_ptr<const AppearanceVector>> vectors;
  for (const MergeMember& member : input.members) {
    std::uint32_t place = below(world.places);
    for (std::size_t i = 0; i < member.vertices.size(); ++i) {
      if (below(3) == 0) place = below(world.places);
      AppearanceVector image;
      image.width_px = static_cast<int>(to_index(member.vertices[i])) + 1;
      image.height_px = 1;
      for (std::uint32_t k = 0; k < world.words_per_image; ++k) {
        const bool is_common = world.common_words > 0 && below(4) == 0;
        const std::uint32_t word =
            is_common ? below(world.common_words)
                      : world.common_words + place * world.words_per_place + below(world.words_per_place);
        image.appearances.push_back(
            {WordId{word}, static_cast<float>(below(320)), static_cast<float>(below(240)), 4, 0});
      }
      if (world.votes == VoteRule::kSignatures && vectors.size() % 6 != 5) {
        for (Appearance& a : image.appearances) a.signature = signature_for(a.word, signatures);
      }
      std::ranges::sort(image.appearances);
      vectors.push_back(std::make_shared<const AppearanceVector>(std::move(image)));
      for (std::uint32_t k = 0; k < 3 && i > 0; ++k) {
        const auto back =
            static_cast<std::uint32_t>(1 + below(static_cast<std::uint32_t>(std::min<std::size_t>(i, 4))));
        const Edge edge{member.vertices[i - back], member.vertices[i], 20 + below(40)};
        const bool is_known =
            std::ranges::any_of(input.inner_edges, [&](const Edge& e) { return e.u == edge.u && e.v == edge.v; });
        if (!is_known) input.inner_edges.push_back(edge);
      }
    }
  }
  input.appearances = std::make_shared<AppearanceTable>(std::move(vectors));
  input.verifier = std::make_shared<HashVerifier>(world.accept_share);
  input.options = {world.method, world.min_votes, world.votes, world.seed};
  return input;
}

ToyWorld toy_world(std::uint32_t seed) {
  const std::vector<std::vector<std::uint32_t>> shapes{{14, 9}, {9, 14}, {11, 11}, {20, 3}, {1, 1}, {30, 25}, {0, 6}};
  ToyWorld world;
  world.seed = seed;
  world.sizes = shapes[seed % shapes.size()];
  world.votes = seed % 2 == 0 ? VoteRule::kMin : VoteRule::kProduct;
  if (seed % 6 == 4) world.votes = VoteRule::kSignatures;
  world.min_votes = 1 + seed % 9;
  world.accept_share = 0.1 + 0.2 * (seed % 5);
  world.places = 3 + seed % 10;
  return world;
}

ToyWorld toy_world_of_several(std::uint32_t seed) {
  ToyWorld world = toy_world(seed);
  const std::vector<std::vector<std::uint32_t>> shapes{{8, 8, 8}, {12, 5, 9}, {4, 9, 6, 7}, {0, 5, 6}, {3, 3, 3, 3, 3}};
  world.sizes = shapes[seed % shapes.size()];
  return world;
}

ToyWorld long_toy_world(std::uint32_t seed) {
  ToyWorld world;
  world.sizes = {70, 45};
  world.places = 25;
  world.min_votes = 2;
  world.accept_share = 0.2;
  world.seed = seed;
  return world;
}

ToyWorld large_toy_world(std::uint32_t seed, std::string_view method) {
  ToyWorld world = toy_world(seed);
  world.method = method;
  world.sizes = {40, 30};
  world.accept_share = 0.4;
  return world;
}

Verification HashVerifier::verify(const AppearanceVector& a, const AppearanceVector& b) const {
  const auto [low, high] = std::minmax(a.width_px, b.width_px);
  std::uint64_t hash = (static_cast<std::uint64_t>(low) << 32) | static_cast<std::uint64_t>(high);
  Verification result;
  result.accepted = static_cast<double>(next_random(hash) % 10000) < accept_share_ * 10000;
  result.matches = 20 + static_cast<int>(next_random(hash) % 60);
  if (!result.accepted) {
    result.inliers = static_cast<int>(next_random(hash) % 12);
    result.reason = next_random(hash) % 2 == 0 ? Reason::kTooFewInliers : Reason::kNotSignificant;
    return result;
  }
  result.inliers = 12 + static_cast<int>(next_random(hash) % 8);
  result.log10_false_alarms = -6.5 - static_cast<double>(next_random(hash) % 40) / 4;
  result.kind = GeometryKind::kFundamental;
  for (double& entry : result.geometry) entry = static_cast<double>(next_random(hash) % 1000) / 1000 - 0.5;
  for (int i = 0; i < result.inliers; ++i) {
    result.inlier_matches.emplace_back(static_cast<std::uint16_t>(i), static_cast<std::uint16_t>((i * 7) % 20));
  }
  return result;
}

}  // namespace mapweld::test
