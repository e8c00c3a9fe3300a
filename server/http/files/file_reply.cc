#include "server/http/files/file_reply.h"

#include <algorithm>
#include <cerrno>
#include <optional>
#include <string_view>
#include <system_error>
#include <utility>

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include "client/contract/problem_document.h"
#include "server/http/problem.h"
#include "server/http/wire/text.h"

namespace mapweld::server {
namespace {

constexpr std::uint64_t kPiece = 256 * 1024;

[[noreturn]] void fail(const std::string& doing) { throw std::system_error(errno, std::generic_category(), doing); }

struct ByteRange {
  std::uint64_t first = 0;
  std::uint64_t count = 0;
};

// "bytes=0-499", "bytes=500-", "bytes=-500"; nothing for what is to be ignored.
std::optional<ByteRange> parse_range(std::string_view text, std::uint64_t bytes) {
  constexpr std::string_view kUnit = "bytes=";
  if (lower(text.substr(0, kUnit.size())) != kUnit || text.find(',') != std::string_view::npos) return std::nullopt;
  text = trim(text.substr(kUnit.size()));
  const std::size_t dash = text.find('-');
  if (dash == std::string_view::npos) return std::nullopt;
  std::uint64_t first = 0;
  std::uint64_t last = 0;
  const bool has_first = parse_whole(text.substr(0, dash), first, 10);
  const bool has_last = parse_whole(text.substr(dash + 1), last, 10);
  if ((!has_first && dash > 0) || (!has_last && dash + 1 < text.size()) || (!has_first && !has_last)) {
    return std::nullopt;
  }
  if (has_first && has_last && last < first) return std::nullopt;
  if (!has_first) return ByteRange{bytes - std::min(last, bytes), std::min(last, bytes)};
  if (first >= bytes) return ByteRange{bytes, 0};
  return ByteRange{first, (has_last ? std::min(last, bytes - 1) : bytes - 1) - first + 1};
}

}  // namespace

OpenFile::OpenFile(const std::filesystem::path& file) : descriptor_(::open(file.c_str(), O_RDONLY | O_CLOEXEC)) {
  if (descriptor_ < 0) fail("cannot open " + file.string());
  struct stat status {};
  if (::fstat(descriptor_, &status) != 0) {
    ::close(descriptor_);
    fail("cannot read " + file.string());
  }
  bytes_ = static_cast<std::uint64_t>(status.st_size);
}

OpenFile::~OpenFile() { ::close(descriptor_); }

void OpenFile::read(std::uint64_t at, std::size_t bytes, std::string& into) const {
  const std::size_t before = into.size();
  into.resize(before + bytes);
  std::size_t done = 0;
  while (done < bytes) {
    const ssize_t got = ::pread(descriptor_, into.data() + before + done, bytes - done, static_cast<off_t>(at + done));
    if (got < 0 && errno == EINTR) continue;
    if (got == 0) errno = EIO;
    if (got <= 0) fail("cannot read a file that is being sent");
    done += static_cast<std::size_t>(got);
  }
}

Reply file_reply(const Request& request, std::shared_ptr<const OpenFile> file, const std::string& content_type,
                 const std::string& etag) {
  Reply reply;
  reply.content_type = content_type;
  reply.etag = etag;
  reply.headers = {{"Accept-Ranges", "bytes"}};
  ByteRange part{0, file->bytes()};
  const bool may_be_part = !request.knows(etag) && (request.if_range.empty() || request.if_range == etag);
  if (const auto range = may_be_part ? parse_range(request.range, file->bytes()) : std::nullopt) {
    if (range->count == 0) {
      Reply refusal = problem_reply(contract::problem_of(
          "range_not_satisfiable", "There are " + std::to_string(file->bytes()) + " bytes, from 0 on.",
          request.request_id));
      refusal.headers.emplace_back("Content-Range", "bytes */" + std::to_string(file->bytes()));
      return refusal;
    }
    part = *range;
    reply.status = 206;
    reply.headers.emplace_back("Content-Range", "bytes " + std::to_string(part.first) + "-" +
                                                    std::to_string(part.first + part.count - 1) + "/" +
                                                    std::to_string(file->bytes()));
  }
  reply.stream_bytes = part.count;
  reply.stream = [file = std::move(file), at = part.first, left = part.count](std::string& piece) mutable {
    const auto size = std::min(left, kPiece);
    file->read(at, static_cast<std::size_t>(size), piece);
    at += size;
    left -= size;
    return left > 0;
  };
  return reply;
}

}  // namespace mapweld::server
