// Why a pair of images has an edge in a map, or none.
#pragma once

#include <cstdint>
#include <string_view>

#include "client/contract/pair.h"
#include "schema/store.h"

namespace mapweld::server {

// What is known of the pair of u and v, numbers of a merged map in either order: of images that come together in a
// merge what that one knows, of a job that runs as of its last checkpoint; of two images of one plain map what its
// mapping has made of them. `with_matches` adds what the images have in common: as it was stored with an edge, for any
// other pair as the verifier finds it now (one verification; it changes nothing). Mapping keeps no refusals: for two
// images of one map without an edge the verifier is asked in any case. Reads the two images and, for a pair of a merge
// without an edge, the job's rejected pairs page by page, never the rest of its checkpoint.
//
// Throws ContractError no_such_merge; no_such_vertex for a number beyond the map (what a member has gained beyond its
// watermark has none); invalid_parameter for one vertex twice. StoreError.
contract::Pair explain_pair(Store& store, std::int64_t merge, std::uint32_t u, std::uint32_t v, bool with_matches);

// The same of two vertices of a map, plain or merged. Throws ContractError no_such_map besides.
contract::Pair explain_pair(Store& store, std::string_view map, std::uint32_t u, std::uint32_t v, bool with_matches);

}  // namespace mapweld::server
