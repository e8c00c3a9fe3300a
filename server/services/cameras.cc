#include "server/services/cameras.h"

#include <algorithm>
#include <cmath>

#include "client/contract/json.h"
#include "core/geometry/pose/relative_pose.h"
#include "schema/maps/camera_store.h"

namespace mapweld::server {
namespace {

using contract::ContractError;
using contract::Json;

template <class Document>
std::optional<Document> of_row(const std::optional<std::string>& row) {
  if (!row) return std::nullopt;
  try {
    Document document = contract::parse_json(*row).get<Document>();
    contract::check(document);
    return document;
  } catch (const ContractError&) {
    return std::nullopt;
  }
}

Camera camera_of(const contract::Camera& c) {
  Camera camera{.model = c.model == "opencv"    ? CameraModel::kOpencv
                         : c.model == "fisheye" ? CameraModel::kFisheye
                                                : CameraModel::kPinhole,
                .fx_px = c.fx_px,
                .fy_px = c.fy_px,
                .cx_px = c.cx_px,
                .cy_px = c.cy_px};
  std::copy_n(c.distortion.begin(), std::min(c.distortion.size(), camera.distortion.size()), camera.distortion.begin());
  return camera;
}

double shown(double value) { return std::round(value * 1e6) / 1e6; }

}  // namespace

std::string camera_to_row(const contract::Camera& camera) { return contract::dump(Json(camera)); }
std::string pose_to_row(const contract::Pose& pose) { return contract::dump(Json(pose)); }
std::optional<contract::Camera> camera_of_row(const std::optional<std::string>& row) {
  return of_row<contract::Camera>(row);
}
std::optional<contract::Pose> pose_of_row(const std::optional<std::string>& row) { return of_row<contract::Pose>(row); }

std::optional<contract::Camera> camera_of_map(const Reader& db, MapId map) {
  return camera_of_row(find_map_camera(db, map));
}

std::optional<contract::Camera> camera_of_image(const Reader& db, const ImageRow& image) {
  if (auto own = camera_of_row(image.provenance.camera)) return own;
  return camera_of_map(db, image.map);
}

std::optional<contract::RelativePose> relative_between(const AppearanceVector& a,
                                                       const std::optional<contract::Camera>& camera_a,
                                                       const AppearanceVector& b,
                                                       const std::optional<contract::Camera>& camera_b,
                                                       const Verification& verification) {
  if (!camera_a || !camera_b) return std::nullopt;
  const std::optional<RelativePose> found =
      relative_pose(a, camera_of(*camera_a), b, camera_of(*camera_b), verification.inlier_matches);
  if (!found) return std::nullopt;
  contract::RelativePose relative;
  for (std::size_t r = 0; r < 3; ++r) {
    std::vector<double>& row = relative.rotation_3x3.emplace_back();
    for (std::size_t k = 0; k < 3; ++k) row.push_back(shown(found->rotation[3 * r + k]));
  }
  if (found->direction) {
    relative.direction.emplace();
    for (const double value : *found->direction) relative.direction->push_back(shown(value));
  }
  relative.parallax_deg = std::round(found->parallax_deg * 100) / 100;
  relative.inliers = found->inliers;
  return relative;
}

}  // namespace mapweld::server
