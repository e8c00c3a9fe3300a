// The share of pixels that two images of a rendered world both see.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "tests/support/rendered_world.h"

namespace mapweld::rendered {

// What one image sees, coarsely: enough to tell what it shares with others. About 50 kB.
class ViewRecord {
 public:
  ViewRecord() = default;
  ViewRecord(const RenderedWorld& world, const Pose& pose);

  const Pose& pose() const { return pose_; }

 private:
  friend double shared_view(const ViewRecord& a, const ViewRecord& b);
  friend double seen_by(const ViewRecord& a, const ViewRecord& b);

  static constexpr int kPointsAcross = 32;
  static constexpr int kPointsDown = 24;
  static constexpr int kScale = 2;  // the grid of surfaces is so many times coarser than the image

  struct Point {
    float x, y, z;
    std::uint16_t surface;
  };
  Pose pose_;
  CameraModel camera_;
  std::array<float, 12> to_camera_{};  // rotation and translation: right, down, forward
  // Surfaces go by a hash of 16 bits here: half the memory, and one collision in 65536.
  std::vector<Point> points_;                 // what 32 x 24 pixels, evenly spread, see
  std::vector<std::uint16_t> surfaces_;       // seen at each place of the coarse grid
  std::array<std::uint64_t, 8> signature_{};  // a Bloom filter of the surfaces seen
};

// The share of a's pixels whose surface point b sees as well: it projects into b's image, nothing hides it there, and
// both look at it from the same side, their lines of sight less than 90 degrees apart (two robots who face each other
// along a corridor see the same walls, but not alike). Estimated on 32 x 24 pixels of a.
double seen_by(const ViewRecord& a, const ViewRecord& b);

// Co-visibility of two images, 0..1: the smaller of seen_by(a, b) and seen_by(b, a). Symmetric: at least this share of
// either image is seen by the other. 0 for images of different storeys. Some microseconds for a pair that shares
// anything, nanoseconds for one that does not.
double shared_view(const ViewRecord& a, const ViewRecord& b);

std::vector<ViewRecord> view_records(const RenderedWorld& world, const std::vector<Pose>& poses, int threads = 1);

struct SharedPair {
  std::int32_t a = 0;  // index in the first list
  std::int32_t b = 0;  // index in the second list
  double shared = 0;
};
// All pairs that share at least `min_shared` > 0, by (a, b).
std::vector<SharedPair> shared_pairs(const std::vector<ViewRecord>& a, const std::vector<ViewRecord>& b,
                                     double min_shared = 0.05, int threads = 1);

}  // namespace mapweld::rendered
