// What is uploaded, and what becomes of it.
#pragma once

#include <cstddef>
#include <cstdint>
#include <exception>
#include <span>
#include <string>
#include <variant>

#include "client/contract/image.h"
#include "core/types.h"
#include "schema/maps/vertex_store.h"
#include "schema/store.h"

namespace mapweld::server {

struct ImageUpload {
  std::string name;                     // empty: the vertex number
  std::span<const std::uint8_t> bytes;  // must live until the upload returns
  Provenance provenance;
};

struct UploadOutcome {
  contract::Upload upload;
  bool created = false;  // a vertex was inserted now; false for an ignored image and a repeated upload
};

// What became of one image of a batch.
using BatchOutcome = std::variant<UploadOutcome, std::exception_ptr>;

// An image of a batch by its place there, and what became of it; `took_ms` without its commit.
struct StoredUpload {
  std::size_t place = 0;
  const UploadOutcome& outcome;
};

// The documents of the contract; `inserted` has no edges yet.
contract::Upload inserted(VertexId vertex, const std::string& name, int features, Reason reason);
contract::Upload ignored(VertexId similar_to, int inliers, IgnoredReason reason, const std::string& name, int features);

// What the first upload of a stored image was answered, but for the time it took.
UploadOutcome first_outcome(const Reader& db, const ImageRow& image);

}  // namespace mapweld::server
