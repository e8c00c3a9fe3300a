// Cameras as they are stored and spoken of, and how two of them stand to each other.
#pragma once

#include <optional>
#include <string>

#include "client/contract/camera.h"
#include "core/types.h"
#include "schema/maps/vertex_store.h"
#include "schema/store.h"

namespace mapweld::server {

// As a row has them. What a file from elsewhere has there may be none: nullopt.
std::string camera_to_row(const contract::Camera& camera);
std::string pose_to_row(const contract::Pose& pose);
std::optional<contract::Camera> camera_of_row(const std::optional<std::string>& row);
std::optional<contract::Pose> pose_of_row(const std::optional<std::string>& row);

// That of a plain map; of a merged one none.
std::optional<contract::Camera> camera_of_map(const Reader& db, MapId map);
// That which took an image: its own, or its map's.
std::optional<contract::Camera> camera_of_image(const Reader& db, const ImageRow& image);

// From the first image to the second, by the matches that held; nullopt where a camera is not known or they do not
// tell. The inlier matches are of these two, in this order.
std::optional<contract::RelativePose> relative_between(const AppearanceVector& a,
                                                       const std::optional<contract::Camera>& camera_a,
                                                       const AppearanceVector& b,
                                                       const std::optional<contract::Camera>& camera_b,
                                                       const Verification& verification);

}  // namespace mapweld::server
