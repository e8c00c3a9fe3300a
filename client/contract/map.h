// Maps, plain and merged.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "client/contract/camera.h"
#include "client/contract/codec.h"
#include "client/contract/edge_counts.h"

namespace mapweld::contract {

// How images become vertices and edges. In a request an absent field means the server's default; in an answer all are
// there.
struct MapParameters {
  std::optional<int> max_features;          // strongest SIFT features kept of an image
  std::optional<int> min_votes;             // fewest votes of a candidate; default: the rule's
  std::optional<int> min_inliers;           // fewest verified matches of an edge
  std::optional<int> max_inliers;           // an image with more to some vertex is ignored as too similar
  std::optional<int> verify_top;            // best candidates verified when localizing and mapping
  std::optional<std::string> votes;         // "min", "product" or "signatures"
  std::optional<std::string> store_images;  // "full" or "none"
  static constexpr auto fields() {
    using P = MapParameters;
    return std::tuple(
        omitted_when_empty("max_features", &P::max_features), omitted_when_empty("min_votes", &P::min_votes),
        omitted_when_empty("min_inliers", &P::min_inliers), omitted_when_empty("max_inliers", &P::max_inliers),
        omitted_when_empty("verify_top", &P::verify_top), omitted_when_empty("votes", &P::votes),
        omitted_when_empty("store_images", &P::store_images));
  }
  friend bool operator==(const MapParameters&, const MapParameters&) = default;
};

// POST /v1/maps
struct CreateMap {
  std::string name;                         // slug, unique on the server
  std::optional<std::string> uuid;          // absent: the server makes one
  std::optional<std::string> vocabulary;    // absent: the server's default
  std::optional<MapParameters> parameters;  // absent: the server's defaults
  std::optional<std::map<std::string, std::string>> labels;
  static constexpr auto fields() {
    using C = CreateMap;
    return std::tuple(required("name", &C::name), omitted_when_empty("uuid", &C::uuid),
                      omitted_when_empty("vocabulary", &C::vocabulary),
                      omitted_when_empty("parameters", &C::parameters), omitted_when_empty("labels", &C::labels));
  }
  friend bool operator==(const CreateMap&, const CreateMap&) = default;
};

// What a request to create a map must obey beyond its types. Throws ContractError(invalid_name) for names,
// (invalid_parameter) for the rest; the detail names the field and its range.
void check(const CreateMap& request);

// PATCH /v1/maps/{map}: what is absent stays as it is.
struct ChangeMap {
  std::optional<std::string> name;
  std::optional<std::map<std::string, std::string>> labels;  // all of them
  std::optional<MapParameters> parameters;                   // those that change
  std::optional<Camera> camera;                              // without a model: takes it away
  static constexpr auto fields() {
    using C = ChangeMap;
    return std::tuple(omitted_when_empty("name", &C::name), omitted_when_empty("labels", &C::labels),
                      omitted_when_empty("parameters", &C::parameters), omitted_when_empty("camera", &C::camera));
  }
  friend bool operator==(const ChangeMap&, const ChangeMap&) = default;
};

// The same of a request to change one.
void check(const ChangeMap& request);

// A member of a merged map, with how many of its vertices the merge has taken in.
struct MapMember {
  std::string map;
  std::int64_t watermark = 0;
  static constexpr auto fields() {
    return std::tuple(field("map", &MapMember::map), field("watermark", &MapMember::watermark));
  }
  friend bool operator==(const MapMember&, const MapMember&) = default;
};

// Which pixels of a map's images bear features.
struct MapMask {
  int width_px = 0;
  int height_px = 0;
  double used_share = 0;  // of its pixels
  std::string sha256;     // of the PNG
  static constexpr auto fields() {
    using M = MapMask;
    return std::tuple(field("width_px", &M::width_px), field("height_px", &M::height_px),
                      field("used_share", &M::used_share), field("sha256", &M::sha256));
  }
  friend bool operator==(const MapMask&, const MapMask&) = default;
};

struct Map {
  std::string name;
  std::string kind = "map";  // "map", or "merged"
  std::string vocabulary;
  std::int64_t vertices = 0;
  std::int64_t edges = 0;  // confirmed ones, inter-map edges included
  EdgeCounts edge_counts;
  std::int64_t ignored = 0;  // images that were not inserted
  std::string uuid;
  MapParameters parameters;
  std::map<std::string, std::string> labels;
  std::optional<MapMask> mask;        // absent: every pixel is used
  std::optional<Camera> camera;       // of its images that name none; absent: nobody said, and in a merged map
  double static_share = 0;            // of the frame; what looks the same in every image, and is left out
  std::vector<MapMember> members;     // of a merged map, in the order of submission
  std::optional<std::int64_t> merge;  // the merge that owns a merged map; absent in a plain map
  std::string created_at;             // RFC 3339, UTC
  std::int64_t revision = 0;          // grows with every change to the map
  static constexpr auto fields() {
    return std::tuple(field("name", &Map::name), field("kind", &Map::kind), field("vocabulary", &Map::vocabulary),
                      field("vertices", &Map::vertices), field("edges", &Map::edges),
                      field("edge_counts", &Map::edge_counts), field("ignored", &Map::ignored),
                      field("uuid", &Map::uuid), field("parameters", &Map::parameters), field("labels", &Map::labels),
                      omitted_when_empty("mask", &Map::mask), omitted_when_empty("camera", &Map::camera),
                      field("static_share", &Map::static_share), field("members", &Map::members),
                      omitted_when_empty("merge", &Map::merge), field("created_at", &Map::created_at),
                      field("revision", &Map::revision));
  }
  friend bool operator==(const Map&, const Map&) = default;
};

}  // namespace mapweld::contract
