#include "client/upload.h"

#include <algorithm>
#include <array>
#include <chrono>
#include <cstdio>
#include <map>
#include <random>
#include <stdexcept>
#include <string_view>
#include <thread>
#include <utility>

#include "client/contract/names.h"
#include "client/image_folder.h"
#include "client/pose_file.h"

namespace mapweld::client {
namespace {

using contract::Problem;
using Outcome = UploadedFile::Outcome;

// Problems of one image, after which the next one may well be taken. All others are the upload's.
bool concerns_one_image(const Problem& problem) {
  constexpr std::array<std::string_view, 9> kCodes = {"name_taken",        "image_too_large",   "body_too_large",
                                                      "empty_body",        "invalid_name",      "unsupported_image",
                                                      "undecodable_image", "invalid_parameter", "malformed_json"};
  return std::find(kCodes.begin(), kCodes.end(), problem.code) != kCodes.end();
}

bool may_pass(const ServerProblem& problem) {
  return problem.code() == "rate_limited" || problem.status() == 503 || problem.code() == "idempotency_in_progress";
}

// 128 random bits.
std::string make_idempotency_key() {
  std::random_device random;
  std::string key;
  for (int i = 0; i < 4; ++i) {
    char digits[9];
    std::snprintf(digits, sizeof(digits), "%08x", static_cast<unsigned>(random()));
    key += digits;
  }
  return key;
}

// A name that cannot stand in a part's header, or is read in more than one way there, goes by itself, in the query.
bool fits_in_form(const std::string& name) { return name.find_first_of("\"\\%") == std::string::npos; }

class Uploader {
 public:
  Uploader(Client& client, const UploadOptions& options, const UploadObserver& observer)
      : client_(client), options_(options), observer_(observer) {
    if (options.batch_images < 1 || options.batch_images > contract::kMaxBatchImages || options.threads < 1 ||
        options.batch_bytes < 1) {
      throw std::invalid_argument("A batch has 1 to 64 images, and one thread or more reads them.");
    }
  }

  UploadReport run() {
    std::vector<std::filesystem::path> paths = image_files(options_.directory);
    report_.files = static_cast<std::int64_t>(paths.size());
    const std::map<std::string, std::string> stored = with_retries([&] { return stored_images(); });
    report_progress();
    ReadAhead files(std::move(paths), options_.threads, 2 * static_cast<std::size_t>(options_.batch_images),
                    [&](const std::filesystem::path& path) { return stored.count(path.filename().string()) != 0; });
    while (auto file = files.next()) {
      const std::string name = file->path.filename().string();
      const auto known = stored.find(name);
      if (!file->error.empty()) {
        flush();
        refuse(name, {"", "The file cannot be read", 0, file->error, "unreadable_file", ""});
      } else if (!contract::is_image_name(name)) {
        flush();
        refuse(name, contract::problem_of("invalid_name",
                                          "The file's name is not 1 to 255 bytes of UTF-8 without "
                                          "control characters.",
                                          ""));
      } else if (known != stored.end() && (known->second.empty() || known->second == file->sha256)) {
        flush();
        settle({name, Outcome::kSkipped, {}});
      } else {
        const contract::Pose* pose = find_pose(options_.poses, name);
        add({name, std::move(file->bytes), {options_.camera, pose ? std::optional(*pose) : std::nullopt}});
      }
    }
    flush();
    report_progress();
    return report_;
  }

 private:
  // Name and SHA-256 of every image that the map has seen.
  std::map<std::string, std::string> stored_images() {
    std::map<std::string, std::string> stored;
    for (const auto& vertex : *client_.vertices(options_.map)) stored[vertex.name] = vertex.sha256;
    for (const auto& image : *client_.ignored(options_.map)) stored[image.name] = image.sha256;
    return stored;
  }

  void add(ImageFile image) {
    const auto size = static_cast<std::int64_t>(image.bytes.size());
    const bool alone = !fits_in_form(image.name);
    if (alone || batch_bytes_ + size > options_.batch_bytes) flush();
    batch_bytes_ += size;
    batch_.push_back(std::move(image));
    if (alone || static_cast<int>(batch_.size()) == options_.batch_images) flush();
  }

  void flush() {
    if (batch_.empty()) return;
    send(std::exchange(batch_, {}));
    batch_bytes_ = 0;
    report_progress();
  }

  void send(std::vector<ImageFile> images) {
    std::vector<contract::BatchItem> items;
    const std::string key = make_idempotency_key();  // of this request, however often it is sent
    try {
      items = with_retries([&]() -> std::vector<contract::BatchItem> {
        if (images.size() == 1) return {client_.upload_image(options_.map, images[0], key).value};
        return client_.upload_batch(options_.map, images, key).value.items;
      });
    } catch (const ServerProblem& error) {
      if (images.size() == 1 && concerns_one_image(error.problem())) {
        refuse(images[0].name, error.problem());
        return;
      }
      if (error.code() != "body_too_large" || images.size() == 1) throw;
      const auto middle = images.begin() + static_cast<std::ptrdiff_t>(images.size() / 2);
      std::vector<ImageFile> second(std::make_move_iterator(middle), std::make_move_iterator(images.end()));
      images.erase(middle, images.end());
      send(std::move(images));
      send(std::move(second));
      return;
    }
    for (std::size_t i = 0; i < items.size(); ++i) {
      report_.sent_bytes += static_cast<std::int64_t>(images[i].bytes.size());
      if (const auto* problem = std::get_if<Problem>(&items[i])) {
        if (!concerns_one_image(*problem)) throw ServerProblem(*problem);
        refuse(images[i].name, *problem);
      } else {
        const bool inserted = std::get<contract::Upload>(items[i]).outcome == "inserted";
        settle({images[i].name, inserted ? Outcome::kInserted : Outcome::kIgnored, std::move(items[i])});
      }
    }
  }

  // Repeats `ask` while there is no answer or one that may change, with growing pauses.
  template <class Ask>
  auto with_retries(const Ask& ask) -> decltype(ask()) {
    double pause_s = 0.25;
    double waited_s = 0;
    for (;;) {
      std::string why;
      double wait_s = pause_s;
      try {
        auto answer = ask();
        reached_ = true;
        return answer;
      } catch (const ConnectionError& error) {
        // Before anything was sent, an address where nobody answers is more likely wrong than restarting.
        if (waited_s >= options_.give_up_after_s || !reached_) throw;
        why = error.what();
      } catch (const ServerProblem& error) {
        reached_ = true;
        if (waited_s >= options_.give_up_after_s || !may_pass(error)) throw;
        why = error.what();
        wait_s = std::clamp(error.retry_after_s(), pause_s, 60.0);
      }
      ++report_.retries;
      if (observer_.retry) observer_.retry(why, wait_s);
      std::this_thread::sleep_for(std::chrono::duration<double>(wait_s));
      waited_s += wait_s;
      pause_s = std::min(2 * pause_s, 8.0);
    }
  }

  void refuse(const std::string& name, const Problem& problem) { settle({name, Outcome::kRefused, problem}); }

  void settle(const UploadedFile& file) {
    switch (file.outcome) {
      case Outcome::kInserted:
        ++report_.inserted;
        break;
      case Outcome::kIgnored:
        ++report_.ignored;
        break;
      case Outcome::kSkipped:
        ++report_.skipped;
        break;
      case Outcome::kRefused:
        ++report_.refused;
        break;
    }
    if (observer_.file) observer_.file(file);
  }

  void report_progress() {
    if (observer_.progress) observer_.progress(report_);
  }

  Client& client_;
  const UploadOptions& options_;
  const UploadObserver& observer_;
  std::vector<ImageFile> batch_;
  std::int64_t batch_bytes_ = 0;
  bool reached_ = false;  // the server has answered before
  UploadReport report_;
};

}  // namespace

UploadReport upload_directory(Client& client, const UploadOptions& options, const UploadObserver& observer) {
  return Uploader(client, options, observer).run();
}

}  // namespace mapweld::client
