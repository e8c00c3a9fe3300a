// Cameras and poses as people have them in files.
#pragma once

#include <filesystem>
#include <map>
#include <string>

#include "client/contract/camera.h"

namespace mapweld::client {

// A camera written "fx,fy,cx,cy" (a pinhole) or "fx,fy,cx,cy,k1,k2,p1,p2[,k3]" (OpenCV's polynomial), or the name of a
// file that holds one as JSON of the contract. Throws std::invalid_argument for what is neither,
// contract::ContractError for a camera that cannot be, std::system_error for a file that cannot be read.
contract::Camera read_camera(const std::string& text);

// Poses as in the trajectories of TUM's benchmark: a line an image, "name tx ty tz qx qy qz qw", metres and a unit
// quaternion, camera to frame; lines that begin with # are passed over. A name is that of an image's file, with or
// without what follows the last dot. Throws std::invalid_argument, which says the line, and as read_camera.
std::map<std::string, contract::Pose> read_poses(const std::filesystem::path& file, const std::string& frame);

// The pose of an image by its file's name, or by that without its ending; nullptr where there is none.
const contract::Pose* find_pose(const std::map<std::string, contract::Pose>& poses, const std::string& name);

}  // namespace mapweld::client
