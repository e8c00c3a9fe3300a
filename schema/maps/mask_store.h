// Table `map_masks`: which pixels of a plain map's images bear features.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "schema/store.h"
#include "schema/store_types.h"

namespace mapweld {

struct MaskRow {
  Sha256 sha256{};  // of the bytes
  int width_px = 0;
  int height_px = 0;
  std::int64_t used_pixels = 0;  // 1 or more
  Timestamp set_at;
};

// Gives a map its mask in place of any that it has, and grows its revision. `bytes`: the PNG.
void set_mask(WriteTransaction& db, MapId map, const MaskRow& mask, std::span<const std::uint8_t> bytes);

// Takes it away. False, and nothing changed, when the map has none.
bool clear_mask(WriteTransaction& db, MapId map);

std::optional<MaskRow> find_mask(const Reader& db, MapId map);
// The PNG; nullopt when the map has no mask.
std::optional<std::vector<std::uint8_t>> load_mask_bytes(const Reader& db, MapId map);

}  // namespace mapweld
