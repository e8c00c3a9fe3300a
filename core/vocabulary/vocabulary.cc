#include "core/vocabulary/vocabulary.h"

#include <algorithm>
#include <array>

#include <zstd.h>

#include "core/errors.h"
#include "core/vocabulary/byte_stream.h"
#include "core/vocabulary/foreign_vocabulary.h"
#include "core/vocabulary/hnsw_layout.h"

namespace mapweld {
namespace {

constexpr std::array<std::uint8_t, 8> kMagic = {'M', 'W', 'V', 'O', 'C', 'A', 'B', '\n'};
constexpr std::uint32_t kFormat = 1;
constexpr std::size_t kHeaderBytes = kMagic.size() + sizeof(std::uint32_t) + sizeof(std::uint64_t);
constexpr std::uint64_t kMaxContentBytes = std::uint64_t{1} << 31;
constexpr std::uint32_t kMaxWords = 1u << 22;
constexpr int kCompressionLevel = 19;

std::vector<std::uint8_t> compress(std::span<const std::uint8_t> content) {
  const std::unique_ptr<ZSTD_CCtx, decltype(&ZSTD_freeCCtx)> context(ZSTD_createCCtx(), ZSTD_freeCCtx);
  if (context == nullptr) throw std::bad_alloc();
  ZSTD_CCtx_setParameter(context.get(), ZSTD_c_compressionLevel, kCompressionLevel);
  ZSTD_CCtx_setParameter(context.get(), ZSTD_c_checksumFlag, 1);
  std::vector<std::uint8_t> frame(ZSTD_compressBound(content.size()));
  const std::size_t size = ZSTD_compress2(context.get(), frame.data(), frame.size(), content.data(), content.size());
  if (ZSTD_isError(size) != 0) throw std::runtime_error(std::string("zstd: ") + ZSTD_getErrorName(size));
  frame.resize(size);
  return frame;
}

std::vector<std::uint8_t> decompress(std::span<const std::uint8_t> frame, std::uint64_t content_bytes) {
  if (content_bytes > kMaxContentBytes || ZSTD_getFrameContentSize(frame.data(), frame.size()) != content_bytes) {
    throw FormatError("vocabulary file: its sizes do not agree");
  }
  std::vector<std::uint8_t> content(content_bytes);
  const std::size_t size = ZSTD_decompress(content.data(), content.size(), frame.data(), frame.size());
  if (ZSTD_isError(size) != 0 || size != content_bytes) throw FormatError("vocabulary file: torn or corrupt");
  return content;
}

// Row-major to column-major and back: one component of all words together compresses better than one word.
std::vector<std::uint8_t> transpose(std::span<const std::uint8_t> from, std::size_t rows, std::size_t columns) {
  std::vector<std::uint8_t> to(from.size());
  for (std::size_t row = 0; row < rows; ++row) {
    for (std::size_t column = 0; column < columns; ++column) to[column * rows + row] = from[row * columns + column];
  }
  return to;
}

}  // namespace

// The index refers to the centroids beside it, so neither moves once made. A centroid fills two cache lines, not three.
struct Vocabulary::Parts {
  std::vector<CacheLine> lines;
  std::span<const std::uint8_t> centroids;
  std::unique_ptr<WordIndex> index;

  explicit Parts(std::span<const std::uint8_t> rows)
      : lines((rows.size() + sizeof(CacheLine) - 1) / sizeof(CacheLine)) {
    auto* bytes = reinterpret_cast<std::uint8_t*>(lines.data());
    std::copy(rows.begin(), rows.end(), bytes);
    centroids = {bytes, rows.size()};
  }
};

Vocabulary::Vocabulary(const std::vector<std::uint8_t>& centroids, const WordIndexOptions& options) {
  if (centroids.empty()) throw FormatError("a vocabulary without words");
  if (centroids.size() / kDescriptorDimension > kMaxWords) throw FormatError("a vocabulary of too many words");
  auto parts = std::make_shared<Parts>(centroids);
  parts->index = build_word_index(parts->centroids, options);
  parts_ = std::move(parts);
}

Vocabulary::Vocabulary(std::shared_ptr<const Parts> parts) : parts_(std::move(parts)) {}

std::uint32_t Vocabulary::words() const {
  return static_cast<std::uint32_t>(parts_->centroids.size() / kDescriptorDimension);
}
std::span<const std::uint8_t> Vocabulary::centroids() const { return parts_->centroids; }
const WordIndex& Vocabulary::index() const { return *parts_->index; }

std::vector<WordId> Vocabulary::quantise(const Features& features) const {
  std::vector<WordId> words(features.keypoints.size());
  if (features.descriptors.size() != words.size() * kDescriptorDimension) {
    throw std::invalid_argument("Vocabulary::quantise: 128 bytes a keypoint are needed");
  }
  parts_->index->quantise(features.descriptors, words);
  return words;
}

std::vector<std::uint8_t> Vocabulary::serialize() const {
  ByteWriter content;
  content.number(words());
  content.number(std::uint32_t{kDescriptorDimension});
  content.text("sift-u8");
  content.text(parts_->index->engine());
  const std::vector<std::uint8_t> columns = transpose(parts_->centroids, words(), kDescriptorDimension);
  content.array(std::span(columns));
  const std::vector<std::uint8_t> index = parts_->index->serialize();
  content.array(std::span(index));
  const std::vector<std::uint8_t> bytes = content.take();

  ByteWriter file;
  for (const std::uint8_t byte : kMagic) file.number(byte);
  file.number(kFormat);
  file.number<std::uint64_t>(bytes.size());
  std::vector<std::uint8_t> out = file.take();
  const std::vector<std::uint8_t> frame = compress(bytes);
  out.insert(out.end(), frame.begin(), frame.end());
  return out;
}

namespace {

// What a file holds.
struct Content {
  std::uint32_t words = 0;
  std::string engine;
  std::vector<std::uint8_t> centroids;  // row-major
  std::vector<std::uint8_t> index;
};

Content read_content(std::span<const std::uint8_t> bytes) {
  if (bytes.size() < kHeaderBytes || !std::equal(kMagic.begin(), kMagic.end(), bytes.begin())) {
    throw FormatError("not a vocabulary file");
  }
  ByteReader header(bytes.subspan(kMagic.size(), kHeaderBytes - kMagic.size()));
  const auto format = header.number<std::uint32_t>();
  if (format != kFormat) {
    throw FormatError("vocabulary file of format " + std::to_string(format) + "; this program reads format 1");
  }
  const std::vector<std::uint8_t> unpacked = decompress(bytes.subspan(kHeaderBytes), header.number<std::uint64_t>());

  ByteReader reader(unpacked);
  Content content;
  content.words = reader.number<std::uint32_t>();
  const auto dimension = reader.number<std::uint32_t>();
  const std::string descriptor = reader.text();
  content.engine = reader.text();
  const auto columns = reader.array<std::uint8_t>();
  content.index = reader.array<std::uint8_t>();
  reader.expect_end();
  if (dimension != kDescriptorDimension || descriptor != "sift-u8") {
    throw FormatError("vocabulary file for other descriptors: " + descriptor);
  }
  if (content.words == 0 || content.words > kMaxWords ||
      columns.size() != std::size_t{content.words} * kDescriptorDimension) {
    throw FormatError("vocabulary file: words and centroids do not agree");
  }
  content.centroids = transpose(columns, kDescriptorDimension, content.words);
  return content;
}

}  // namespace

std::shared_ptr<const Vocabulary> Vocabulary::deserialize(std::span<const std::uint8_t> bytes) {
  const Content content = read_content(bytes);
  auto parts = std::make_shared<Parts>(content.centroids);
  parts->index = load_word_index(parts->centroids, content.engine, content.index);
  return std::shared_ptr<const Vocabulary>(new Vocabulary(std::move(parts)));
}

std::shared_ptr<const Vocabulary> deserialize_foreign(std::span<const std::uint8_t> bytes) {
  const Content content = read_content(bytes);
  if (content.engine != "flann") return Vocabulary::deserialize(bytes);
  WordIndexOptions options;
  options.engine = content.engine;
  auto vocabulary = std::make_shared<const Vocabulary>(content.centroids, options);
  if (vocabulary->index().serialize() != content.index) {
    throw FormatError("vocabulary file: its FLANN index is not the one that is built of its words");
  }
  return vocabulary;
}

}  // namespace mapweld
