// A folder of photographs into a map, in one go or in several.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "client/client.h"

namespace mapweld::client {

struct UploadOptions {
  std::string map;
  std::filesystem::path directory;
  int threads = 2;                              // that read and hash files ahead; never changes the map
  int batch_images = 32;                        // images a request, 1 .. 64
  std::int64_t batch_bytes = 24 << 20;          // a request ends before it grows beyond this, with one image at least
  double give_up_after_s = 30;                  // of asking again while the server cannot be reached or is too busy
  std::optional<contract::Camera> camera = {};  // of all the images
  std::map<std::string, contract::Pose> poses = {};  // by name: find_pose of client/pose_file.h
};

// What became of a file. `item` is the server's word on it, except for files that it never got.
struct UploadedFile {
  enum class Outcome : std::uint8_t {
    kInserted,
    kIgnored,
    kSkipped,  // the map had it already, inserted or ignored: same name, same bytes
    kRefused,  // by the server; or its name is not allowed, or it cannot be read
  };
  std::string name;
  Outcome outcome = Outcome::kSkipped;
  contract::BatchItem item;  // a Problem for refused ones; of skipped ones empty
};

struct UploadReport {
  std::int64_t files = 0;  // photographs in the folder; the next four add up to it at the end
  std::int64_t inserted = 0;
  std::int64_t ignored = 0;
  std::int64_t skipped = 0;
  std::int64_t refused = 0;
  std::int64_t sent_bytes = 0;
  std::int64_t retries = 0;
  std::int64_t settled() const { return inserted + ignored + skipped + refused; }
};

struct UploadObserver {
  std::function<void(const UploadReport& so_far)> progress;          // after every batch
  std::function<void(const UploadedFile&)> file;                     // once a file, in their order
  std::function<void(const std::string& why, double wait_s)> retry;  // before it waits
};

// Uploads the photographs of a folder (client/image_folder.h says which, and in which order), named by their file
// names. Batches go one after the other, each when the one before is committed: the map is the same for any number of
// threads and however often the upload was broken off and begun again. What the map already has is not sent again.
// Asks again after a broken connection and after 429 `rate_limited` and 503, each request under an idempotency key of
// its own: it takes effect once. Throws what Client throws when the whole upload cannot go on,
// std::filesystem::filesystem_error for the folder, std::invalid_argument for options out of range. A refused image
// does not end the upload.
UploadReport upload_directory(Client& client, const UploadOptions& options, const UploadObserver& observer = {});

}  // namespace mapweld::client
