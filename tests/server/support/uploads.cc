#include "tests/server/support/uploads.h"

#include <cstdint>

#include "tests/server/support/test_photos.h"

namespace mapweld::test {

server::ImageUpload upload_of(const std::string& name, const std::string& bytes) {
  server::ImageUpload upload;
  upload.name = name;
  upload.bytes = {reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size()};
  return upload;
}

std::vector<server::ImageUpload> name_all(const std::vector<std::string>& images) {
  std::vector<server::ImageUpload> uploads;
  for (std::size_t i = 0; i < images.size(); ++i) uploads.push_back(upload_of("image-" + std::to_string(i), images[i]));
  return uploads;
}

std::vector<std::string> drive_there_and_back(int steps) {
  std::vector<std::string> images;
  for (int step = 0; step < steps; ++step) images.push_back(photo_jpeg(1, step));
  for (int step = steps - 1; step >= steps / 2; --step) images.push_back(photo_jpeg(1, step) + std::string(1, '\0'));
  return images;
}

std::vector<ServicesOptions> upload_variants() {
  constexpr std::size_t kRoom = std::size_t{256} << 20;
  const auto variant = [](int workers, int max_group, std::size_t cache_bytes) {
    ServicesOptions options;
    options.workers = workers;
    options.images.max_group = max_group;
    options.cache_bytes = cache_bytes;
    return options;
  };
  return {variant(1, 16, kRoom), variant(4, 16, kRoom), variant(8, 3, kRoom), variant(2, 16, 0)};
}

}  // namespace mapweld::test
