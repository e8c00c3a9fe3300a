// The types that the whole house speaks in. Plain values: no behaviour beyond comparison.
//
// Conventions, stated once:
// - Pixel coordinates: x to the right, y down; the centre of the upper left pixel is (0, 0), as in OpenCV.
// - Angles in degrees, [0, 360), clockwise in the image (y down), as OpenCV's SIFT gives them.
// - Units are in the names: _px, _deg, _s, _ms.
// - Ids are strong enums; `to_index(id)` is the number inside.
#pragma once

#include <array>
#include <compare>
#include <cstdint>
#include <optional>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

namespace mapweld {

enum class MapId : std::int64_t {};
enum class JobId : std::int64_t {};
enum class VertexId : std::uint32_t {};  // counts from 0 within its map; never reused
enum class WordId : std::uint32_t {};    // index of a visual word in its vocabulary

// The number inside a strong id.
template <typename Id>
constexpr auto to_index(Id id) {
  return static_cast<std::underlying_type_t<Id>>(id);
}

inline constexpr int kDescriptorDimension = 128;

// A SIFT keypoint. `scale_px` is the diameter of the neighbourhood (OpenCV's KeyPoint::size).
struct Keypoint {
  float x_px = 0;
  float y_px = 0;
  float scale_px = 0;
  float angle_deg = 0;
  friend auto operator<=>(const Keypoint&, const Keypoint&) = default;
};

// What feature extraction finds in one image. Descriptors are bytes: SIFT's components are whole numbers 0..255 to
// begin with, and integer distances are the same on every processor.
struct Features {
  int width_px = 0;
  int height_px = 0;
  std::vector<Keypoint> keypoints;        // N, strongest first
  std::vector<std::uint8_t> descriptors;  // N x 128, row-major
  friend bool operator==(const Features&, const Features&) = default;
};

// A SIFT descriptor in 128 bits: which of its components are greater than their median (Zhou et al., "Scalar
// quantization for large scale image search", ACM Multimedia 2012). The Hamming distance of two signatures follows the
// distance of the descriptors. That of a descriptor is never zero; zero says that it is not known.
struct Signature {
  std::array<std::uint32_t, 4> bits{};
  friend auto operator<=>(const Signature&, const Signature&) = default;
};

// The appearance of a visual word in an image (paper, section III).
// Its coordinates lie on the grid of `snap_to_grid` (core/vocabulary/appearance_vector.h), so that what is stored in
// a compact blob and read back is bit for bit what was verified at ingest.
struct Appearance {
  WordId word{};
  float x_px = 0;
  float y_px = 0;
  float scale_px = 0;
  float angle_deg = 0;
  Signature signature{};  // all appearances of an image have one, or none has
  friend auto operator<=>(const Appearance&, const Appearance&) = default;
};

// The paper's sparse appearance vector v_q of one image: its appearances, sorted by (word, x, y, scale, angle,
// signature). Those that its map takes for the camera's own stand apart, sorted as well: they neither vote nor match,
// and are in no index or number of features, but help to tell what two images have without displacement.
struct AppearanceVector {
  int width_px = 0;
  int height_px = 0;
  std::vector<Appearance> appearances;
  std::vector<Appearance> static_appearances = {};  // core/mapping/static_content.h
  friend auto operator<=>(const AppearanceVector&, const AppearanceVector&) = default;
};

// How the similarity S of two images is counted from equal words (docs/design.md, "Votes").
enum class VoteRule : std::uint8_t {
  kMin,         // sum over words of min(c_i, c_j): bounds the number of one-to-one matches
  kProduct,     // sum over words of c_i * c_j: the paper's S
  kSignatures,  // as kMin, of features whose signatures agree: core/retrieval/vote_signature.h
};

// The word of http-api.md for a rule ("min", "product", "signatures").
std::string_view to_string(VoteRule rule);
// The other way; nullopt for a word that is none.
std::optional<VoteRule> parse_vote_rule(std::string_view word);
// From so many votes on a pair is worth verifying, unless somebody says otherwise; measured: docs/votes.md.
std::uint32_t default_min_votes(VoteRule rule);

// A pair of images worth verifying: `source` in m2, `target` in m1 (paper, section V), with its votes.
struct Candidate {
  VertexId source{};
  VertexId target{};
  std::uint32_t votes = 0;
  friend auto operator<=>(const Candidate&, const Candidate&) = default;
};

// Why a pair, an upload or a query found no match. `kNone`: it did.
enum class Reason : std::uint8_t {
  kNone,
  kTooFewFeatures,  // an image has fewer features than a match needs
  kNoCandidate,     // no image of the map shares enough words
  kTooFewInliers,   // fewer than min_inliers matches agree on one geometry
  kNotSignificant,  // enough inliers, but chance explains them (number of false alarms too high)
  kInconsistent,    // inliers fall apart under spatial consistency, or nothing around them matches
  kUnsupported,     // verified, but not confirmed by its neighbourhood (alias guard)
  kAmbiguous,       // verified, but so is a place elsewhere, and nothing decides between them (alias guard)
};

// The word of http-api.md for a reason ("too_few_inliers", ...); empty for kNone.
std::string_view to_string(Reason reason);
// The other way; nullopt for a word that is none, kNone for an empty one.
std::optional<Reason> parse_reason(std::string_view word);

// What geometry two views obey.
enum class GeometryKind : std::uint8_t { kNone, kFundamental, kHomography };

// The verdict on a pair of images (a, b); see core/geometry/pair_verifier.h.
struct Verification {
  bool accepted = false;
  Reason reason = Reason::kNone;
  int matches = 0;                // one-to-one word matches that went into the estimation
  int inliers = 0;                // matches that survived geometry and spatial consistency
  double log10_false_alarms = 0;  // log10 of the a-contrario number of false alarms of the inlier set
  GeometryKind kind = GeometryKind::kNone;
  std::array<double, 9> geometry{};  // 3x3 row-major; for kFundamental  x_b^T F x_a = 0
  // Inlier matches: indices into a.appearances and b.appearances, ascending.
  std::vector<std::pair<std::uint16_t, std::uint16_t>> inlier_matches;
  friend bool operator==(const Verification&, const Verification&) = default;
};

// An undirected edge between two similar images of one graph, u < v; its weight is the number of verified inliers.
struct Edge {
  VertexId u{};
  VertexId v{};
  std::uint32_t weight = 0;
  friend auto operator<=>(const Edge&, const Edge&) = default;
};

}  // namespace mapweld
