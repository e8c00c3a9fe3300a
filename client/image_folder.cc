#include "client/image_folder.h"

#include <algorithm>
#include <array>
#include <cerrno>
#include <fstream>
#include <sstream>
#include <system_error>
#include <utility>

#include <openssl/evp.h>

namespace mapweld::client {
namespace fs = std::filesystem;

std::vector<fs::path> image_files(const fs::path& directory) {
  std::vector<fs::path> files;
  for (const fs::directory_entry& entry : fs::directory_iterator(directory)) {
    std::string extension = entry.path().extension().string();
    for (char& c : extension) c = c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
    const bool photograph = extension == ".jpg" || extension == ".jpeg" || extension == ".png";
    std::error_code unused;
    if (photograph && entry.path().filename().string().front() != '.' && entry.is_regular_file(unused)) {
      files.push_back(entry.path());
    }
  }
  std::sort(files.begin(), files.end(),
            [](const fs::path& a, const fs::path& b) { return a.filename().native() < b.filename().native(); });
  return files;
}

std::string read_file(const fs::path& path) {
  std::ifstream file(path, std::ios::binary);
  std::ostringstream bytes;
  if (file && file.peek() != std::ifstream::traits_type::eof()) bytes << file.rdbuf();
  if (!file.is_open() || file.bad() || fs::is_directory(path)) {
    const int error = fs::is_directory(path) ? EISDIR : errno != 0 ? errno : EIO;
    throw std::system_error(error, std::generic_category(), "Cannot read " + path.string());
  }
  return std::move(bytes).str();
}

std::string sha256_hex(std::string_view bytes) {
  std::array<unsigned char, EVP_MAX_MD_SIZE> digest{};
  unsigned int size = 0;
  if (EVP_Digest(bytes.data(), bytes.size(), digest.data(), &size, EVP_sha256(), nullptr) != 1) {
    throw std::runtime_error("SHA-256 is not to be had from OpenSSL");
  }
  constexpr char kHex[] = "0123456789abcdef";
  std::string text;
  for (unsigned int i = 0; i < size; ++i) text += {kHex[digest[i] >> 4U], kHex[digest[i] & 15U]};
  return text;
}

std::string_view media_type(std::string_view bytes) {
  if (bytes.substr(0, 3) == "\xFF\xD8\xFF") return "image/jpeg";
  if (bytes.substr(0, 4) == "\x89PNG") return "image/png";
  return "application/octet-stream";
}

ReadAhead::ReadAhead(std::vector<fs::path> paths, int threads, std::size_t ahead,
                     std::function<bool(const fs::path&)> hash)
    : paths_(std::move(paths)), hash_(std::move(hash)), slots_(std::max<std::size_t>(1, ahead)) {
  for (int i = 0; i < std::max(1, threads); ++i) threads_.emplace_back([this] { read_files(); });
}

ReadAhead::~ReadAhead() {
  {
    const std::lock_guard lock(mutex_);
    stopped_ = true;
  }
  changed_.notify_all();
  for (std::thread& thread : threads_) thread.join();
}

void ReadAhead::read_files() {
  std::unique_lock lock(mutex_);
  for (;;) {
    changed_.wait(lock, [&] { return stopped_ || begun_ == paths_.size() || begun_ < given_ + slots_.size(); });
    if (stopped_ || begun_ == paths_.size()) return;
    const std::size_t index = begun_++;
    lock.unlock();
    File file{.path = paths_[index], .bytes = {}, .sha256 = {}, .error = {}};
    try {
      file.bytes = read_file(file.path);
      if (hash_(file.path)) file.sha256 = sha256_hex(file.bytes);
    } catch (const std::exception& error) {
      file.bytes.clear();
      file.error = error.what();
    }
    lock.lock();
    slots_[index % slots_.size()] = std::move(file);
    changed_.notify_all();
  }
}

std::optional<ReadAhead::File> ReadAhead::next() {
  std::unique_lock lock(mutex_);
  if (given_ == paths_.size()) return std::nullopt;
  std::optional<File>& slot = slots_[given_ % slots_.size()];
  changed_.wait(lock, [&] { return slot.has_value(); });
  std::optional<File> file = std::exchange(slot, std::nullopt);
  ++given_;
  lock.unlock();
  changed_.notify_all();
  return file;
}

}  // namespace mapweld::client
