#include "server/training/training_checkpoint.h"

#include <cerrno>
#include <cstring>
#include <fstream>
#include <iterator>

#include <fcntl.h>
#include <unistd.h>

#include "core/errors.h"
#include "core/vocabulary/byte_stream.h"
#include "server/training/descriptor_file.h"

namespace mapweld {
namespace {

constexpr std::uint64_t kMagic = 0x314B50434E52544Du;  // "MTRNCPK1"

[[noreturn]] void fail(const std::string& what, const std::filesystem::path& path) {
  throw TrainingFileError(what + " " + path.string() + ": " + std::strerror(errno));
}

std::vector<std::uint8_t> encode(const TrainingCheckpoint& checkpoint) {
  ByteWriter writer;
  writer.number(kMagic);
  writer.number(checkpoint.fingerprint);
  writer.number(checkpoint.images_done);
  writer.number(checkpoint.descriptors);
  writer.number(checkpoint.held_out);
  writer.number<std::uint64_t>(checkpoint.skipped.size());
  for (const SkippedImage& image : checkpoint.skipped) {
    writer.text(image.path);
    writer.text(image.reason);
  }
  writer.number<std::uint8_t>(checkpoint.kmeans.has_value());
  if (checkpoint.kmeans) {
    writer.array(std::span<const std::uint8_t>(checkpoint.kmeans->centroids));
    writer.number<std::uint64_t>(checkpoint.kmeans->history.size());
    for (const IterationReport& iteration : checkpoint.kmeans->history) {
      writer.number(iteration.distortion);
      writer.number(iteration.moved);
      writer.number(iteration.empty);
    }
  }
  writer.number(checkpoint.extraction_s);
  writer.number(checkpoint.start_s);
  writer.number(checkpoint.iterations_s);
  return writer.take();
}

TrainingCheckpoint decode(std::span<const std::uint8_t> bytes) {
  ByteReader reader(bytes);
  if (reader.number<std::uint64_t>() != kMagic) throw FormatError("unknown format");
  TrainingCheckpoint checkpoint;
  checkpoint.fingerprint = reader.number<std::uint64_t>();
  checkpoint.images_done = reader.number<std::uint64_t>();
  checkpoint.descriptors = reader.number<std::uint64_t>();
  checkpoint.held_out = reader.number<std::uint64_t>();
  for (auto left = reader.number<std::uint64_t>(); left > 0; --left) {
    SkippedImage image;
    image.path = reader.text();
    image.reason = reader.text();
    checkpoint.skipped.push_back(std::move(image));
  }
  if (reader.number<std::uint8_t>() != 0) {
    KMeansState state;
    state.centroids = reader.array<std::uint8_t>();
    for (auto left = reader.number<std::uint64_t>(); left > 0; --left) {
      IterationReport iteration;
      iteration.distortion = reader.number<std::uint64_t>();
      iteration.moved = reader.number<std::uint64_t>();
      iteration.empty = reader.number<std::uint32_t>();
      state.history.push_back(iteration);
    }
    checkpoint.kmeans = std::move(state);
  }
  checkpoint.extraction_s = reader.number<double>();
  checkpoint.start_s = reader.number<double>();
  checkpoint.iterations_s = reader.number<double>();
  reader.expect_end();
  return checkpoint;
}

}  // namespace

std::uint64_t fnv1a(std::span<const std::uint8_t> bytes, std::uint64_t hash) {
  for (const std::uint8_t byte : bytes) hash = (hash ^ byte) * 0x100000001B3u;
  return hash;
}

void replace_file(const std::filesystem::path& path, std::span<const std::uint8_t> bytes) {
  std::filesystem::path fresh = path;
  fresh += ".new";
  const int file = open(fresh.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0644);
  if (file < 0) fail("cannot create", fresh);
  bool written = true;
  for (std::size_t done = 0; done < bytes.size() && written;) {
    const ssize_t put = write(file, bytes.data() + done, bytes.size() - done);
    if (put < 0 && errno == EINTR) continue;
    written = put > 0;
    if (written) done += static_cast<std::size_t>(put);
  }
  written = written && fsync(file) == 0;
  const int error = errno;
  close(file);
  if (!written || rename(fresh.c_str(), path.c_str()) != 0) {
    if (!written) errno = error;
    fail("cannot write", path);
  }
}

std::vector<std::uint8_t> read_file(const std::filesystem::path& path) {
  std::ifstream stream(path, std::ios::binary);
  if (!stream || std::filesystem::is_directory(path)) fail("cannot read", path);
  std::vector<std::uint8_t> bytes((std::istreambuf_iterator<char>(stream)), std::istreambuf_iterator<char>());
  if (stream.bad()) fail("cannot read", path);
  return bytes;
}

void save_checkpoint(const std::filesystem::path& path, const TrainingCheckpoint& checkpoint) {
  std::vector<std::uint8_t> bytes = encode(checkpoint);
  ByteWriter checksum;
  checksum.number(fnv1a(bytes));
  const auto tail = checksum.take();
  bytes.insert(bytes.end(), tail.begin(), tail.end());
  replace_file(path, bytes);
}

std::optional<TrainingCheckpoint> load_checkpoint(const std::filesystem::path& path) {
  if (!std::filesystem::exists(path)) return std::nullopt;
  const std::vector<std::uint8_t> bytes = read_file(path);
  const std::span<const std::uint8_t> all(bytes);
  if (all.size() < sizeof(std::uint64_t)) throw FormatError(path.string() + ": torn");
  const auto body = all.first(all.size() - sizeof(std::uint64_t));
  if (ByteReader(all.last(sizeof(std::uint64_t))).number<std::uint64_t>() != fnv1a(body)) {
    throw FormatError(path.string() + ": torn");
  }
  return decode(body);
}

}  // namespace mapweld
