// Images on their way into a map, one by one or in a batch.
#pragma once

#include <string>
#include <vector>

#include "server/services/image_service.h"
#include "tests/server/support/services_under_test.h"

namespace mapweld::test {

// `bytes` must outlive it.
server::ImageUpload upload_of(const std::string& name, const std::string& bytes);
// "image-0", "image-1", ...; `images` must outlive them.
std::vector<server::ImageUpload> name_all(const std::vector<std::string>& images);

// A drive along a wall, there and half of it back: vertices, edges and ignored images.
std::vector<std::string> drive_there_and_back(int steps);

// Servers that must make the same map of the same images: of several threads, group sizes, with maps in memory or
// straight from the store (a cache of 0).
std::vector<ServicesOptions> upload_variants();

}  // namespace mapweld::test
