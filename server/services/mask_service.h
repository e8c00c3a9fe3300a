// Masks of maps: which pixels of their images bear features.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include <opencv2/core/mat.hpp>

#include "schema/store.h"
#include "server/decoding/image_decoder.h"
#include "server/services/map_service.h"

namespace mapweld::server {

// Thread-safe. Throws ContractError no_such_map; StoreError.
class MaskService {
 public:
  // Both must outlive this.
  MaskService(Store& store, ImageDecoder& decoder) : store_(store), decoder_(decoder) {}

  // From now on the images that the map takes in and queries into it are masked; what it has stays. map_is_merged;
  // ImageError unsupported_image, undecodable_image, image_too_large, empty_mask, empty_body. Then nothing changes.
  void set(const std::string& map, std::span<const std::uint8_t> png);
  StoredImage get(const std::string& map) const;  // no_such_mask
  // Also when there is none. map_is_merged.
  void clear(const std::string& map);

 private:
  Store& store_;
  ImageDecoder& decoder_;
};

// The mask of a map for core/feature/mask.h, from load_mask_bytes(); empty when it has none. Decodes: not for within a
// transaction.
cv::Mat mask_in(const std::optional<std::vector<std::uint8_t>>& png, ImageDecoder& decoder);

}  // namespace mapweld::server
