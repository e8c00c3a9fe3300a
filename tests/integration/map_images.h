// Images for whole-program tests: two robots' rendered photographs, or photographs from MAPWELD_PHOTOS.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "client/client.h"

namespace mapweld::testing {

// Encoded JPEG files named 000000.jpg, 000001.jpg, ...
using Images = std::vector<client::ImageFile>;

struct RobotPair {
  Images a;
  Images b;
};

// Two robots on one floor of a rendered building, overlapping in part, under different light. Rendered once a process
// for given arguments; the reference stays valid.
const RobotPair& rendered_pair(int n_images_a, int n_images_b, std::uint64_t seed);

// The folder with the photographs, or nothing when it is not there.
std::optional<std::filesystem::path> photographs(const std::string& data_set);

// Skips the test, by name, where the photographs of a data set are not there; else names their folder.
#define MAPWELD_REQUIRE_PHOTOGRAPHS(variable, data_set)                                                        \
  const auto variable##_optional = ::mapweld::testing::photographs(data_set);                                  \
  if (!variable##_optional) GTEST_SKIP() << "photographs of " << data_set << " are not here (MAPWELD_PHOTOS)"; \
  const std::filesystem::path variable = *variable##_optional

// Creates `map` and uploads `images` to it, in order. Fails the test when one is refused.
void upload(client::Client& client, const std::string& map, const Images& images,
            std::optional<contract::MapParameters> parameters = {});

// Creates `map` from a folder, as `mapweld upload` does.
void upload_folder(client::Client& client, const std::string& map, const std::filesystem::path& folder,
                   int threads = 2);

// Waits until the merge is at rest, asking every few milliseconds; fails the test after `timeout_s`.
contract::Merge wait_for(client::Client& client, std::int64_t merge, double timeout_s = 120);

// Submits a merge of two maps and waits for its end.
contract::Merge merge(client::Client& client, const std::string& a, const std::string& b, const std::string& name,
                      const std::string& method = "quickconnect");

}  // namespace mapweld::testing
