// Two maps made of images as a server would make them, every candidate pair verified, with the truth about each: what
// rules about inter-map edges are judged on.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <vector>

#include "core/geometry/pair_verifier.h"
#include "core/guard/verified_edge.h"
#include "core/mapping/localizer.h"
#include "core/merge/merge_input.h"
#include "core/merge/merge_state.h"
#include "core/vocabulary/vocabulary.h"
#include "tests/support/overlays.h"
#include "tests/support/rendered_world.h"

namespace mapweld::rendered {

// One member of the merge.
struct MadeMap {
  std::vector<std::shared_ptr<const AppearanceVector>> vertices;
  std::vector<VerifiedEdge> inner_edges;  // own numbers
  std::vector<Pose> poses;                // of the vertices; empty where nobody knows them
  // For each image given: the vertex that it became, or kIgnored.
  static constexpr std::uint32_t kIgnored = 0xFFFFFFFF;
  std::vector<std::uint32_t> vertex_of_image;
};

// The finished merge of two maps: numbers run through a's vertices, then b's.
struct MadeMerge {
  MadeMap a;
  MadeMap b;
  std::vector<MergeEdge> inter_edges;  // every pair with min_votes that the verifier accepts, by (u, v)
  std::vector<float> shared;           // of each inter edge: the share of the view that both images see
  std::vector<float> best_shared;      // of each vertex of b: with the vertex of a that it shares most with
  std::uint64_t candidates = 0;

  std::vector<MergeMember> members() const;
  std::vector<VerifiedEdge> inner_edges() const;  // merged numbers
  AppearanceTable appearances() const;
};

// The shipped vocabulary.
std::shared_ptr<const Vocabulary> shipped_vocabulary();

// Mapping, in the order given.
MadeMap make_map(const std::vector<AppearanceVector>& images, const MapParameters& parameters = {});

// What a robot with these conditions sees at these poses, through JPEG, extractor and vocabulary. `overlay`: laid over
// each frame before it is compressed; the first is frame number `noise_seed`.
std::vector<AppearanceVector> see(const RenderedWorld& world, const std::vector<Pose>& poses,
                                  const CameraConditions& conditions, std::uint64_t noise_seed,
                                  const Vocabulary& vocabulary, int threads, std::optional<Overlay> overlay = {});

// Verifies every candidate. The truth stays empty.
MadeMerge verify_all(MadeMap a, MadeMap b, int threads);

// One robot's drive.
struct Drive {
  const RenderedWorld* world = nullptr;
  std::vector<Pose> poses;
  CameraConditions conditions;
  std::uint64_t noise_seed = 0;
};

// Renders, maps and verifies; with truth. Drives in different worlds share nothing.
MadeMerge make_merge(const Drive& a, const Drive& b, const Vocabulary& vocabulary, int threads,
                     const MapParameters& parameters = {});

// In this machine's byte order: a cache, not a format. Reading throws FormatError for what was not written so.
void write_merge(const MadeMerge& merge, const std::filesystem::path& file);
MadeMerge read_merge(const std::filesystem::path& file);

}  // namespace mapweld::rendered
