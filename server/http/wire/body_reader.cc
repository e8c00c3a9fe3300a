#include "server/http/wire/body_reader.h"

#include <algorithm>

#include "client/contract/problem.h"
#include "server/http/wire/text.h"

namespace mapweld::server {
namespace {

using contract::ContractError;

constexpr std::size_t kMaxLine = 256;  // a chunk's size with its extensions; a trailer field
constexpr int kMaxTrailers = 32;

[[noreturn]] void refuse_chunks() { throw ContractError("malformed_request", "The chunks of the body are malformed."); }

[[noreturn]] void refuse_size(std::uint64_t max_bytes) {
  throw ContractError("body_too_large", "The body may have at most " + std::to_string(max_bytes) + " bytes.");
}

}  // namespace

BodyReader::BodyReader(const Head& head, std::uint64_t max_bytes, BodyBudget& budget, BodyFile* file)
    : max_bytes_(max_bytes), chunked_(head.framing == Framing::kChunked), share_(budget), file_(file) {
  if (head.framing == Framing::kLength) {
    left_ = head.content_length;
    if (left_ > max_bytes) refuse_size(max_bytes);
  }
  expect_ = chunked_ ? Expect::kSizeLine : left_ > 0 ? Expect::kData : Expect::kNothing;
}

bool BodyReader::take(std::string_view& input) {
  while (expect_ != Expect::kNothing && !input.empty()) {
    if (expect_ == Expect::kData) {
      take_data(input);
      if (left_ == 0) expect_ = chunked_ ? Expect::kEndOfChunk : Expect::kNothing;
      continue;
    }
    if (!take_line(input)) return false;
    if (expect_ == Expect::kSizeLine) {
      begin_chunk();
    } else if (expect_ == Expect::kEndOfChunk) {
      if (!line_.empty()) refuse_chunks();
      expect_ = Expect::kSizeLine;
    } else if (line_.empty()) {
      expect_ = Expect::kNothing;
    } else if (++trailers_ > kMaxTrailers) {
      refuse_chunks();
    }
    line_.clear();
  }
  return expect_ == Expect::kNothing;
}

// RFC 9112, section 7.1.
void BodyReader::begin_chunk() {
  if (!parse_whole(trim(std::string_view(line_).substr(0, line_.find(';'))), left_, 16)) refuse_chunks();
  if (left_ > max_bytes_ - bytes_) refuse_size(max_bytes_);
  expect_ = left_ > 0 ? Expect::kData : Expect::kTrailer;
}

// True: `line_` is a whole line, without its end.
bool BodyReader::take_line(std::string_view& input) {
  const std::size_t end = input.find('\n');
  const std::size_t size = end == std::string_view::npos ? input.size() : end + 1;
  if (line_.size() + size > kMaxLine + 2) refuse_chunks();
  line_.append(input.substr(0, size));
  input.remove_prefix(size);
  if (end == std::string_view::npos) return false;
  if (!line_.ends_with("\r\n")) refuse_chunks();
  line_.resize(line_.size() - 2);
  if (line_.find('\r') != std::string::npos) refuse_chunks();
  return true;
}

void BodyReader::take_data(std::string_view& input) {
  const auto size = static_cast<std::size_t>(std::min<std::uint64_t>(left_, input.size()));
  if (file_ != nullptr) {
    file_->append(input.substr(0, size));
  } else {
    if (!share_.take(size)) throw ContractError("busy", "The server holds as many uploads as it can. Try again.");
    body_.append(input.substr(0, size));
  }
  bytes_ += size;
  input.remove_prefix(size);
  left_ -= size;
}

}  // namespace mapweld::server
