// Why a pair of images has an edge in a merge, or none.
#pragma once

#include <cstdint>

#include "client/contract/pair.h"
#include "schema/store.h"

namespace mapweld::server {

// What a merge knows of the pair of u and v, numbers of the merged map in either order; of a job that runs, as of its
// last checkpoint. `with_matches` adds what the images have in common: as it was stored with an edge, for any other
// pair as the verifier finds it now (one verification; it changes nothing). Reads the two images and, for a pair
// without an edge, the job's rejected pairs page by page, never the rest of its checkpoint.
//
// Throws ContractError no_such_merge; no_such_vertex for a number beyond the merged map (what a member has gained
// beyond its watermark has none); invalid_parameter for two vertices of one member, which no merge compares.
// StoreError.
contract::Pair explain_pair(Store& store, std::int64_t merge, std::uint32_t u, std::uint32_t v, bool with_matches);

}  // namespace mapweld::server
