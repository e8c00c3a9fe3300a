#include "server/http/wire/compression.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <limits>
#include <memory>
#include <new>
#include <optional>
#include <string>
#include <utility>

#include <zlib.h>

#include "server/http/wire/text.h"

namespace mapweld::server {
namespace {

constexpr std::size_t kMinBytes = 1024;      // of a body; a smaller one gains nothing
constexpr std::size_t kPieceBytes = 32'768;  // written at a time
constexpr int kLevel = 1;   // 2 MB of graph: 16 ms, 0.51 MB; level 6: 47 ms, 0.44 MB
constexpr int kGzip = 16;  // added to the window's bits: gzip's head and sum, not zlib's

// Of one reply; used by one thread at a time.
class Deflater {
 public:
  Deflater() {
    // Memory level 8 is zlib's default.
    if (deflateInit2(&stream_, kLevel, Z_DEFLATED, MAX_WBITS + kGzip, 8, Z_DEFAULT_STRATEGY) != Z_OK) {
      throw std::bad_alloc();
    }
  }
  ~Deflater() { deflateEnd(&stream_); }
  Deflater(const Deflater&) = delete;
  Deflater& operator=(const Deflater&) = delete;

  // Appends to `out` what of `text`, and of what came before it, is ready; all of it when it is the `last`.
  void add(std::string_view text, bool last, std::string& out) {
    constexpr std::size_t kMost = std::numeric_limits<uInt>::max();
    do {
      const std::string_view some = text.substr(0, kMost);
      text.remove_prefix(some.size());
      stream_.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(some.data()));  // it writes nothing there
      stream_.avail_in = static_cast<uInt>(some.size());
      write(last && text.empty() ? Z_FINISH : Z_NO_FLUSH, out);
    } while (!text.empty());
  }

 private:
  void write(int flush, std::string& out) {
    do {
      const std::size_t before = out.size();
      out.resize(before + kPieceBytes);
      stream_.next_out = reinterpret_cast<Bytef*>(out.data() + before);
      stream_.avail_out = static_cast<uInt>(kPieceBytes);
      deflate(&stream_, flush);  // fails only where it can go no further, which is the end here
      out.resize(out.size() - stream_.avail_out);
    } while (stream_.avail_out == 0);
  }

  z_stream stream_{};
};

// A weight of 0 to 1 in thousandths, as in "gzip;q=0.5"; 1000 where there is none.
int weight_of(std::string_view parameters) {
  const std::size_t at = lower(parameters).find("q=");
  if (at == std::string_view::npos) return 1000;
  const std::string_view digits = trim(parameters.substr(at + 2));
  if (digits.empty() || digits.front() == '1') return 1000;
  std::string thousandths(digits.substr(std::min<std::size_t>(digits.size(), 2), 3));
  thousandths.resize(3, '0');
  std::uint64_t weight = 0;
  return digits.front() == '0' && parse_whole(thousandths, weight, 10) ? static_cast<int>(weight) : 0;
}

}  // namespace

bool accepts_gzip(std::string_view accept_encoding) {
  std::optional<int> gzip;
  std::optional<int> any;
  int as_it_is = 0;
  while (!accept_encoding.empty()) {
    const std::size_t comma = std::min(accept_encoding.find(','), accept_encoding.size());
    const std::string_view item = accept_encoding.substr(0, comma);
    accept_encoding.remove_prefix(std::min(comma + 1, accept_encoding.size()));
    const std::size_t semicolon = std::min(item.find(';'), item.size());
    const std::string name = lower(trim(item.substr(0, semicolon)));
    const int weight = weight_of(item.substr(semicolon));
    if (name == "gzip" || name == "x-gzip") gzip = weight;
    if (name == "*") any = weight;
    if (name == "identity") as_it_is = weight;
  }
  const int weight = gzip.value_or(any.value_or(0));
  return weight > 0 && weight >= as_it_is;
}

bool is_compressible(std::string_view content_type) {
  const std::string type = lower(trim(content_type.substr(0, content_type.find(';'))));
  if (type == "text/event-stream") return false;
  return type.starts_with("text/") || type == "application/json" || type.ends_with("+json") || type.ends_with("+xml");
}

void compress(Reply& reply) {
  if (reply.stream) {
    reply.stream = [plain = std::move(reply.stream), deflater = std::make_shared<Deflater>(),
                    text = std::string()](std::string& piece) mutable {
      text.clear();
      const bool more = plain(text);
      deflater->add(text, !more, piece);
      return more;
    };
  } else if (reply.body.size() >= kMinBytes) {
    std::string body;
    Deflater().add(reply.body, true, body);
    reply.body = std::move(body);
  } else {
    return;
  }
  reply.headers.emplace_back("Content-Encoding", "gzip");
  if (reply.etag.starts_with('"')) reply.etag.insert(0, "W/");
}

}  // namespace mapweld::server
