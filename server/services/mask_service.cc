#include "server/services/mask_service.h"

#include <opencv2/core.hpp>

#include "client/contract/problem.h"
#include "core/feature/mask.h"
#include "schema/maps/mask_store.h"
#include "server/services/hashing.h"
#include "server/services/map_lookup.h"
#include "server/services/times.h"

namespace mapweld::server {
namespace {

using contract::ContractError;

constexpr std::string_view kInstead = "its members have their own masks.";  // of a merged map

}  // namespace

void MaskService::set(const std::string& map, std::span<const std::uint8_t> png) {
  require_plain_map(store_.read(), map, kInstead);
  const cv::Mat mask = mask_of(decoder_.decode(png, false));
  MaskRow row;
  row.sha256 = sha256(png);
  row.width_px = mask.cols;
  row.height_px = mask.rows;
  row.used_pixels = cv::countNonZero(mask);
  row.set_at = now();
  WriteTransaction db = store_.write();
  set_mask(db, require_plain_map(db, map, kInstead).id, row, png);
  db.commit();
}

StoredImage MaskService::get(const std::string& map) const {
  const ReadTransaction db = store_.read();
  const MapId id = require_map(db, map).id;
  const auto row = find_mask(db, id);
  const auto bytes = load_mask_bytes(db, id);
  if (!row || !bytes) throw ContractError("no_such_mask", "The map \"" + map + "\" has no mask.");
  return {"image/png", std::string(bytes->begin(), bytes->end()), to_hex(row->sha256)};
}

void MaskService::clear(const std::string& map) {
  WriteTransaction db = store_.write();
  if (clear_mask(db, require_plain_map(db, map, kInstead).id)) db.commit();
}

cv::Mat mask_in(const std::optional<std::vector<std::uint8_t>>& png, ImageDecoder& decoder) {
  return png ? mask_of(decoder.decode(*png, false)) : cv::Mat();
}

}  // namespace mapweld::server
