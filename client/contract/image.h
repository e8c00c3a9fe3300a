// Images: vertices, what became of an upload, and where a query image was found.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "client/contract/camera.h"
#include "client/contract/codec.h"
#include "client/contract/problem_document.h"

namespace mapweld::contract {

inline constexpr int kMaxBatchImages = 64;

// DELETE /v1/maps/{m}/vertices and .../{i}
struct Deleted {
  std::int64_t deleted = 0;  // vertices
  static constexpr auto fields() { return std::tuple(field("deleted", &Deleted::deleted)); }
  friend bool operator==(const Deleted&, const Deleted&) = default;
};

// GET /v1/maps/{m}/vertices/{i}
struct Vertex {
  std::int64_t vertex = 0;
  std::string name;
  int width_px = 0;
  int height_px = 0;
  int features = 0;
  std::int64_t degree = 0;
  std::optional<std::string> captured_at;  // RFC 3339, UTC
  std::optional<std::string> sequence;
  std::optional<std::int64_t> index;  // within the sequence
  std::string sha256;                 // of the stored bytes, hexadecimal
  std::optional<Camera> camera;       // its own; null: its map's, if that has one
  std::optional<Pose> pose;
  std::string map;                 // where the vertex lives: a member of a merged map, a plain map itself
  std::int64_t member_vertex = 0;  // its number there
  static constexpr auto fields() {
    using V = Vertex;
    return std::tuple(field("vertex", &V::vertex), field("name", &V::name), field("width_px", &V::width_px),
                      field("height_px", &V::height_px), field("features", &V::features), field("degree", &V::degree),
                      field("captured_at", &V::captured_at), field("sequence", &V::sequence), field("index", &V::index),
                      field("sha256", &V::sha256), field("camera", &V::camera), omitted_when_empty("pose", &V::pose),
                      field("map", &V::map), field("member_vertex", &V::member_vertex));
  }
  friend bool operator==(const Vertex&, const Vertex&) = default;
};

// GET /v1/maps/{m}/ignored
struct IgnoredImage {
  std::string name;
  std::string reason;  // "too_similar" or "identical"
  std::int64_t similar_to = 0;
  int inliers = 0;
  int features = 0;
  std::optional<std::string> captured_at;
  std::optional<std::string> sequence;
  std::optional<std::int64_t> index;
  std::string sha256;
  std::optional<Camera> camera;  // its own
  std::optional<Pose> pose;
  static constexpr auto fields() {
    using I = IgnoredImage;
    return std::tuple(field("name", &I::name), field("reason", &I::reason), field("similar_to", &I::similar_to),
                      field("inliers", &I::inliers), field("features", &I::features),
                      field("captured_at", &I::captured_at), field("sequence", &I::sequence), field("index", &I::index),
                      field("sha256", &I::sha256), omitted_when_empty("camera", &I::camera),
                      omitted_when_empty("pose", &I::pose));
  }
  friend bool operator==(const IgnoredImage&, const IgnoredImage&) = default;
};

struct UploadEdge {
  std::int64_t vertex = 0;
  std::int64_t votes = 0;
  int inliers = 0;
  bool confirmed = true;             // this and the next: as it stands now, also when an upload is repeated
  std::optional<double> confidence;  // 0 to 1; null: nobody has judged it yet, and it is confirmed
  static constexpr auto fields() {
    using E = UploadEdge;
    return std::tuple(field("vertex", &E::vertex), field("votes", &E::votes), field("inliers", &E::inliers),
                      field("confirmed", &E::confirmed), field("confidence", &E::confidence));
  }
  friend bool operator==(const UploadEdge&, const UploadEdge&) = default;
};

// What became of one image. `vertex` and `edges` belong to "inserted", `similar_to` and `inliers` to "ignored".
struct Upload {
  std::string outcome;  // "inserted" (201) or "ignored" (200)
  std::optional<std::int64_t> vertex;
  std::string name;
  int features = 0;
  std::optional<std::vector<UploadEdge>> edges;
  std::optional<std::string> reason;  // inserted: why it has no edge, or null; ignored: "too_similar" or "identical"
  std::optional<std::int64_t> similar_to;
  std::optional<int> inliers;
  double took_ms = 0;
  static constexpr auto fields() {
    using U = Upload;
    return std::tuple(required("outcome", &U::outcome), omitted_when_empty("vertex", &U::vertex),
                      field("name", &U::name), field("features", &U::features), omitted_when_empty("edges", &U::edges),
                      field("reason", &U::reason), omitted_when_empty("similar_to", &U::similar_to),
                      omitted_when_empty("inliers", &U::inliers), field("took_ms", &U::took_ms));
  }
  friend bool operator==(const Upload&, const Upload&) = default;
};

// POST /v1/maps/{m}/images/batch: an outcome or a problem per part, in order.
using BatchItem = std::variant<Upload, Problem>;
struct Batch {
  std::vector<BatchItem> items;
  friend bool operator==(const Batch&, const Batch&) = default;
};
void to_json(Json& json, const Batch& batch);
void from_json(const Json& json, Batch& batch);  // as the from_json of codec.h; an item with "outcome" is an Upload

// How many of a query's features, candidates and matches were left after each stage.
struct Funnel {
  int features = 0;
  std::int64_t known_words = 0;  // distinct words of the query that the map has
  std::int64_t candidates = 0;   // vertices with min_votes or more
  int verified = 0;              // candidates put to the verifier
  int best_inliers = 0;
  int needed_inliers = 0;
  static constexpr auto fields() {
    using F = Funnel;
    return std::tuple(field("features", &F::features), field("known_words", &F::known_words),
                      field("candidates", &F::candidates), field("verified", &F::verified),
                      field("best_inliers", &F::best_inliers), field("needed_inliers", &F::needed_inliers));
  }
  friend bool operator==(const Funnel&, const Funnel&) = default;
};

struct Match {
  std::int64_t vertex = 0;
  std::string map;
  std::int64_t member_vertex = 0;
  std::string name;
  std::int64_t votes = 0;
  int inliers = 0;
  bool verified = false;
  std::optional<Pose> pose;              // of the vertex
  std::optional<RelativePose> relative;  // from the query to the vertex; absent: no cameras, or the images do not tell
  static constexpr auto fields() {
    using M = Match;
    return std::tuple(field("vertex", &M::vertex), field("map", &M::map), field("member_vertex", &M::member_vertex),
                      field("name", &M::name), field("votes", &M::votes), field("inliers", &M::inliers),
                      field("verified", &M::verified), omitted_when_empty("pose", &M::pose),
                      omitted_when_empty("relative", &M::relative));
  }
  friend bool operator==(const Match&, const Match&) = default;
};

// POST /v1/maps/{m}/localize
struct Localization {
  std::string status;                 // "localized", "ambiguous" or "not_found"
  std::optional<std::string> reason;  // why not, when not localized
  double took_ms = 0;
  Funnel funnel;
  std::vector<Match> matches;  // verified ones by inliers, then the others by votes
  static constexpr auto fields() {
    using L = Localization;
    return std::tuple(required("status", &L::status), field("reason", &L::reason), field("took_ms", &L::took_ms),
                      field("funnel", &L::funnel), field("matches", &L::matches));
  }
  friend bool operator==(const Localization&, const Localization&) = default;
};

}  // namespace mapweld::contract
