#include "schema/blobs/posting_blob.h"

#include <algorithm>
#include <utility>

#include "core/errors.h"
#include "schema/blobs/varint.h"

namespace mapweld::blobs {
namespace {

constexpr char kFormat = 'P';
constexpr std::uint8_t kWithoutSignatures = 1;
constexpr std::uint8_t kWithSignatures = 2;
constexpr std::ptrdiff_t kSignatureBytes = 8;
constexpr std::uint64_t kMostOfVertex = 1u << 24;              // no image has so many features
constexpr std::uint64_t kMostInList = std::uint64_t{1} << 33;  // a vertex's number and a bit

[[noreturn]] void corrupt(const char* what) {
  throw StoreError(StoreErrorKind::kCorrupt, std::string("blob 'P' is damaged: ") + what);
}

std::uint64_t read_number(const std::uint8_t*& at, const std::uint8_t* end) {
  if (const auto value = read_varint(at, end); value && *value <= kMostInList) return *value;
  corrupt("a number does not end");
}

}  // namespace

PostingBlockWriter::PostingBlockWriter(VertexId first_vertex, std::size_t target_bytes, bool with_signatures)
    : first_vertex_(first_vertex), target_bytes_(target_bytes), with_signatures_(with_signatures) {}

void PostingBlockWriter::add(WordId word, const PostingSpan& postings) {
  if (postings.empty()) return;
  const std::size_t begin = lists_.size();
  std::uint32_t next = to_index(first_vertex_);
  for (std::size_t from = 0, to = 0; from < postings.size(); from = to) {
    to = end_of_vertex(postings.vertices, from);
    const std::uint32_t vertex = to_index(postings.vertices[from]);
    if (vertex < next) throw FormatError("postings do not ascend");
    const bool more = to - from > 1;
    append_varint(lists_, std::uint64_t{vertex - next} << 1 | static_cast<std::uint64_t>(more));
    if (more) append_varint(lists_, to - from - 2);
    next = vertex + 1;
  }
  if (with_signatures_) {
    for (VoteSignature signature : postings.signatures) {
      for (int i = 0; i < kSignatureBytes; ++i, signature >>= 8) lists_.push_back(static_cast<std::uint8_t>(signature));
    }
  }
  directory_.emplace_back(word, static_cast<std::uint32_t>(lists_.size() - begin));
  if (lists_.size() + 3 * directory_.size() >= target_bytes_) close();
}

void PostingBlockWriter::close() {
  if (directory_.empty()) return;
  ByteWriter writer(kFormat, with_signatures_ ? kWithSignatures : kWithoutSignatures);
  writer.reserve(lists_.size() + 4 * directory_.size() + 8);
  writer.varint(directory_.size());
  std::uint32_t previous = 0;
  for (const auto& [word, bytes] : directory_) {
    if (to_index(word) < previous) throw FormatError("words do not ascend");
    writer.varint(to_index(word) - previous);
    writer.varint(bytes);
    previous = to_index(word);
  }
  writer.raw(lists_);
  blocks_.push_back({directory_.front().first, std::move(writer).finish()});
  directory_.clear();
  lists_.clear();
}

std::vector<PostingBlockWriter::Block> PostingBlockWriter::finish() && {
  close();
  return std::move(blocks_);
}

PostingBlock::PostingBlock(std::span<const std::uint8_t> blob, VertexId first_vertex, std::uint32_t vertices)
    : first_vertex_(to_index(first_vertex)), vertices_(vertices), with_signatures_(false) {
  ByteReader reader(blob, kFormat, kWithSignatures);
  with_signatures_ = reader.version() == kWithSignatures;
  directory_.resize(reader.varint32(reader.left()));
  std::uint64_t word = 0;
  std::uint64_t offset = 0;
  for (Entry& entry : directory_) {
    const std::uint64_t step = reader.varint();
    if (step == 0 && &entry != directory_.data()) reader.corrupt("words do not ascend");
    word += step;
    if (step > UINT32_MAX || word > UINT32_MAX) reader.corrupt("a word is too large");
    entry.word = WordId{static_cast<std::uint32_t>(word)};
    entry.begin = static_cast<std::uint32_t>(offset);
    offset += reader.varint32(blob.size());
    if (offset > blob.size()) reader.corrupt("a list lies outside");
    entry.end = static_cast<std::uint32_t>(offset);
  }
  lists_ = reader.raw(offset);
  reader.finish();
}

void PostingBlock::postings(std::size_t i, PostingList& out) const {
  const Entry& entry = directory_[i];
  const std::uint8_t* at = lists_.data() + entry.begin;
  const std::uint8_t* end = lists_.data() + entry.end;
  const std::ptrdiff_t bytes_each = with_signatures_ ? kSignatureBytes : 0;
  std::ptrdiff_t postings = 0;
  std::uint64_t next = 0;
  while (end - at > postings * bytes_each) {
    const std::uint64_t head = read_number(at, end);
    const std::uint64_t vertex = next + (head >> 1);
    if (vertex >= vertices_) corrupt("a posting lies outside its segment");
    std::uint64_t count = 1;
    if ((head & 1) != 0) count = 2 + read_number(at, end);
    if (count > kMostOfVertex) corrupt("a count is too large");
    out.vertices.insert(out.vertices.end(), count, VertexId{static_cast<std::uint32_t>(first_vertex_ + vertex)});
    postings += static_cast<std::ptrdiff_t>(count);
    next = vertex + 1;
  }
  if (end - at != postings * bytes_each) corrupt("a list has not one signature a posting");
  const std::size_t before = out.signatures.size();
  out.signatures.resize(before + static_cast<std::size_t>(postings), 0);
  if (!with_signatures_) return;
  for (std::size_t k = before; k < out.signatures.size(); ++k) {
    VoteSignature signature = 0;
    for (std::ptrdiff_t i = kSignatureBytes; i-- > 0;) signature = signature << 8 | at[i];
    out.signatures[k] = signature;
    at += kSignatureBytes;
  }
}

void PostingBlock::find(WordId word, PostingList& out) const {
  const auto found = std::ranges::lower_bound(directory_, word, {}, &Entry::word);
  if (found == directory_.end() || found->word != word) return;
  postings(static_cast<std::size_t>(found - directory_.begin()), out);
}

}  // namespace mapweld::blobs
