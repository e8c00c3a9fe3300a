#include "tests/support/shared_view.h"

#include <algorithm>
#include <stdexcept>

#include "tests/support/rendering/parallel.h"
#include "tests/support/rendering/repeatable.h"

namespace mapweld::rendered {
ViewRecord::ViewRecord(const RenderedWorld& world, const Pose& pose) : pose_(pose), camera_(world.options().camera) {
  if (camera_.width_px % kScale != 0 || camera_.height_px % kScale != 0) {
    throw std::invalid_argument("co-visibility needs images of an even number of pixels");
  }
  const Frame frame = world.render_geometry(pose, kScale);
  const int width = frame.surface.cols;
  const int height = frame.surface.rows;
  const auto short_name = [](int surface) {
    return static_cast<std::uint16_t>(mix(static_cast<std::uint64_t>(surface) + 1) & 0xffffU);
  };
  surfaces_.reserve(static_cast<std::size_t>(width * height));
  for (int i = 0; i < width * height; ++i) surfaces_.push_back(short_name(frame.surface.ptr<int>()[i]));
  for (const std::uint16_t surface : surfaces_) {
    signature_[surface % 512 / 64] |= std::uint64_t{1} << (surface % 64);
  }

  const double ch = cos_deg(pose.heading_deg);
  const double sh = sin_deg(pose.heading_deg);
  const double cp = cos_deg(pose.pitch_deg);
  const double sp = sin_deg(pose.pitch_deg);
  const std::array<std::array<double, 3>, 3> axes{{{sh, -ch, 0}, {ch * sp, sh * sp, -cp}, {ch * cp, sh * cp, sp}}};
  const std::array<double, 3> centre{pose.x_m, pose.y_m, pose.height_m};
  for (std::size_t r = 0; r < 3; ++r) {
    double shift = 0;
    for (std::size_t c = 0; c < 3; ++c) {
      to_camera_[4 * r + c] = static_cast<float>(axes[r][c]);
      shift -= axes[r][c] * centre[c];
    }
    to_camera_[4 * r + 3] = static_cast<float>(shift);
  }
  for (int j = 0; j < kPointsDown; ++j) {
    for (int i = 0; i < kPointsAcross; ++i) {
      const int x = (2 * i + 1) * width / (2 * kPointsAcross);
      const int y = (2 * j + 1) * height / (2 * kPointsDown);
      const std::int32_t surface = frame.surface.at<int>(y, x);
      if (surface < 0) continue;
      const double z = frame.depth_m.at<float>(y, x);
      const double px = x * kScale + (kScale - 1) / 2.0 - (camera_.width_px - 1) / 2.0;
      const double py = y * kScale + (kScale - 1) / 2.0 - (camera_.height_px - 1) / 2.0;
      std::array<float, 3> point{};
      for (std::size_t c = 0; c < 3; ++c) {
        point[c] = static_cast<float>(
            centre[c] + z * (axes[2][c] + axes[0][c] * px / camera_.focal_px + axes[1][c] * py / camera_.focal_px));
      }
      points_.push_back({point[0], point[1], point[2], short_name(surface)});
    }
  }
}

double seen_by(const ViewRecord& a, const ViewRecord& b) {
  if (a.pose_.storey != b.pose_.storey || a.points_.empty()) return 0;
  const std::array<float, 12>& m = b.to_camera_;
  constexpr int kScale = ViewRecord::kScale;
  const int width = b.camera_.width_px / kScale;
  const int height = b.camera_.height_px / kScale;
  const auto focal = static_cast<float>(b.camera_.focal_px / kScale);
  // Pixels are squares about whole coordinates: the image reaches from -0.5 on.
  const float centre_x = static_cast<float>(width) / 2;
  const float centre_y = static_cast<float>(height) / 2;
  const auto ax = static_cast<float>(a.pose_.x_m);
  const auto ay = static_cast<float>(a.pose_.y_m);
  const auto az = static_cast<float>(a.pose_.height_m);
  const auto bx = static_cast<float>(b.pose_.x_m);
  const auto by = static_cast<float>(b.pose_.y_m);
  const auto bz = static_cast<float>(b.pose_.height_m);
  int seen = 0;
  for (const ViewRecord::Point& p : a.points_) {
    const float z = m[8] * p.x + m[9] * p.y + m[10] * p.z + m[11];
    if (!(z > 0.03F)) continue;
    const float x = (m[0] * p.x + m[1] * p.y + m[2] * p.z + m[3]) / z * focal + centre_x;
    const float y = (m[4] * p.x + m[5] * p.y + m[6] * p.z + m[7]) / z * focal + centre_y;
    if (!(x >= 0 && y >= 0 && x < static_cast<float>(width) && y < static_cast<float>(height))) continue;
    const float along = (p.x - ax) * (p.x - bx) + (p.y - ay) * (p.y - by) + (p.z - az) * (p.z - bz);
    if (!(along > 0)) continue;
    // Surfaces are flat and opaque: b sees the point if it sees the point's surface in its direction.
    seen += b.surfaces_[static_cast<std::size_t>(static_cast<int>(y) * width + static_cast<int>(x))] == p.surface;
  }
  return static_cast<double>(seen) / (ViewRecord::kPointsAcross * ViewRecord::kPointsDown);
}

double shared_view(const ViewRecord& a, const ViewRecord& b) {
  if (a.pose_.storey != b.pose_.storey) return 0;
  std::uint64_t common = 0;
  for (std::size_t i = 0; i < a.signature_.size(); ++i) common |= a.signature_[i] & b.signature_[i];
  if (common == 0) return 0;
  const double forth = seen_by(a, b);
  return forth > 0 ? std::min(forth, seen_by(b, a)) : 0;
}

std::vector<ViewRecord> view_records(const RenderedWorld& world, const std::vector<Pose>& poses, int threads) {
  std::vector<ViewRecord> records(poses.size());
  for_each_index(static_cast<int>(poses.size()), threads, [&](int i) {
    records[static_cast<std::size_t>(i)] = ViewRecord(world, poses[static_cast<std::size_t>(i)]);
  });
  return records;
}

std::vector<SharedPair> shared_pairs(const std::vector<ViewRecord>& a, const std::vector<ViewRecord>& b,
                                     double min_shared, int threads) {
  std::vector<std::vector<SharedPair>> rows(a.size());
  for_each_index(static_cast<int>(a.size()), threads, [&](int i) {
    for (std::size_t j = 0; j < b.size(); ++j) {
      const double shared = shared_view(a[static_cast<std::size_t>(i)], b[j]);
      if (shared > 0 && shared >= min_shared) {
        rows[static_cast<std::size_t>(i)].push_back({i, static_cast<std::int32_t>(j), shared});
      }
    }
  });
  std::vector<SharedPair> pairs;
  for (const std::vector<SharedPair>& row : rows) pairs.insert(pairs.end(), row.begin(), row.end());
  return pairs;
}

}  // namespace mapweld::rendered
