// Robots along painted walls, whose pictures' shift is known: pairs to be explained.
#pragma once

#include <chrono>
#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "server/services/pair_service.h"
#include "tests/server/support/services_under_test.h"
#include "tests/server/support/test_photos.h"

namespace mapweld::test {

// Two robots on one wall, the second two steps further; and one on a wall of its own.
class PairsOfWalls : public ::testing::Test {
 protected:
  static constexpr int kSteps = 4;
  static constexpr double kStepPx = 200;  // of the camera along the wall (test_photos.h)

  PairsOfWalls() {
    for (const char* name : {"a", "b", "c"}) services_.create_map(name);
    for (int step = 0; step < kSteps; ++step) {
      services_.upload("a", "a-" + std::to_string(step), photo_jpeg(1, step));
      services_.upload("b", "b-" + std::to_string(step), photo_jpeg(1, step + 2));
      services_.upload("c", "c-" + std::to_string(step), photo_jpeg(7, step));
    }
  }

  std::int64_t merge(std::vector<std::string> maps, const std::string& name,
                     std::optional<std::int64_t> verifications = {}) {
    contract::SubmitMerge submit;
    submit.maps = std::move(maps);
    submit.name = name;
    if (verifications) {
      submit.budget.emplace();
      submit.budget->verifications = verifications;
    }
    const std::int64_t id = services_.merges().submit(submit).id;
    services_.jobs().wait(id, std::chrono::seconds(30));
    return id;
  }

  contract::Pair explain(std::int64_t merge, std::uint32_t u, std::uint32_t v, bool with_matches = true) {
    return server::explain_pair(services_.store(), merge, u, v, with_matches);
  }
  std::string code(std::int64_t merge, std::uint32_t u, std::uint32_t v) {
    return code_of([&] { explain(merge, u, v, false); });
  }

  // That each match shows one spot of the wall: `u_step`, `v_step` say where the two cameras stood.
  void expect_one_wall(const contract::Pair& pair, int u_step, int v_step) {
    ASSERT_TRUE(pair.inlier_matches);
    EXPECT_GE(pair.inlier_matches->size(), 8u);
    for (const contract::PointMatch& match : *pair.inlier_matches) {
      EXPECT_NEAR(match.u.x_px + u_step * kStepPx, match.v.x_px + v_step * kStepPx, 3);
      EXPECT_NEAR(match.u.y_px, match.v.y_px, 3);
    }
  }

  ServicesUnderTest services_;
};

}  // namespace mapweld::test
