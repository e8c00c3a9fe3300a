#include "server/api/idempotency.h"

#include <algorithm>
#include <array>
#include <chrono>
#include <fstream>
#include <string_view>
#include <vector>

#include <spdlog/spdlog.h>

#include "client/contract/image.h"
#include "client/contract/problem.h"
#include "schema/maps/map_store.h"
#include "server/http/multipart.h"
#include "server/services/hashing.h"

namespace mapweld::server {
namespace {

using contract::ContractError;

constexpr std::chrono::hours kKeptFor{24};
constexpr std::size_t kDroppedAtOnce = 16;  // expired answers, with each that is kept
constexpr std::size_t kMaxKeyBytes = 255;
constexpr const char* kReplayed = "Idempotent-Replayed";

void check_key(const std::string& key) {
  const bool visible = std::ranges::all_of(key, [](char c) { return c > ' ' && c < 0x7F; });
  if (visible && !key.empty() && key.size() <= kMaxKeyBytes) return;
  throw ContractError("invalid_parameter", "\"Idempotency-Key\" must be 1 to 255 visible ASCII characters.");
}

// Texts that follow each other, each told by its length.
class RequestHash {
 public:
  void add(std::string_view text) {
    add_size(text.size());
    hash_.update({reinterpret_cast<const std::uint8_t*>(text.data()), text.size()});
  }
  void add_file(const BodyFile& file) {
    add_size(file.bytes());
    std::ifstream in(file.path(), std::ios::binary);
    std::vector<std::uint8_t> piece(std::size_t{1} << 20);
    while (in.read(reinterpret_cast<char*>(piece.data()), static_cast<std::streamsize>(piece.size())),
           in.gcount() > 0) {
      hash_.update({piece.data(), static_cast<std::size_t>(in.gcount())});
    }
    if (in.bad()) throw StoreError(StoreErrorKind::kIo, "cannot read " + file.path().string());
  }
  void add_size(std::uint64_t size) {
    std::array<std::uint8_t, 8> bytes{};
    for (std::size_t i = 0; i < bytes.size(); ++i) bytes[i] = static_cast<std::uint8_t>(size >> (8 * i));
    hash_.update(bytes);
  }
  Sha256 finish() { return hash_.finish(); }

 private:
  Sha256Hash hash_;
};

// Of a form its parts count, not the boundary between them, which clients draw anew.
Sha256 hash_of(const Request& request) {
  RequestHash hash;
  hash.add(request.method);
  hash.add(request.path);
  hash.add_size(request.query.values().size());
  for (const auto& [name, value] : request.query.values()) {
    hash.add(name);
    hash.add(value);
  }
  if (request.body_file) {
    hash.add_file(*request.body_file);
  } else if (request.content_type.starts_with("multipart/")) {
    for (const Part& part :
         parse_multipart(request.body, multipart_boundary(request.content_type), contract::kMaxBatchImages + 1)) {
      hash.add(part.name);
      hash.add(part.file_name);
      hash.add(part.content);
    }
  } else {
    hash.add(request.body);
  }
  return hash.finish();
}

std::string header_lines(const Reply& reply) {
  std::string lines;
  if (!reply.content_type.empty()) lines += "Content-Type: " + reply.content_type + "\n";
  for (const auto& [name, value] : reply.headers) lines.append(name).append(": ").append(value).append("\n");
  return lines;
}

Reply reply_of(const KeptAnswer& answer) {
  Reply reply;
  reply.status = answer.status;
  reply.body = answer.body;
  std::string_view lines = answer.headers;
  while (!lines.empty()) {
    const std::string_view line = lines.substr(0, lines.find('\n'));
    lines.remove_prefix(std::min(line.size() + 1, lines.size()));
    const std::size_t colon = std::min(line.find(": "), line.size());
    const std::string name(line.substr(0, colon));
    const std::string value(line.substr(std::min(colon + 2, line.size())));
    if (name == "Content-Type") {
      reply.content_type = value;
    } else {
      reply.headers.emplace_back(name, value);
    }
  }
  return reply;
}

bool is_success(const Reply& reply) { return reply.status >= 200 && reply.status <= 299; }

}  // namespace

// A key while its request is under way.
class IdempotencyKeys::Turn {
 public:
  Turn(IdempotencyKeys& keys, const AnswerKey& key) : keys_(keys), key_(key.caller, key.text) {
    const std::lock_guard lock(keys_.mutex_);
    if (keys_.under_way_.insert(key_).second) return;
    throw ContractError("idempotency_in_progress",
                        "A request with this Idempotency-Key is still under way. Ask again when it is done.");
  }
  ~Turn() {
    const std::lock_guard lock(keys_.mutex_);
    keys_.under_way_.erase(key_);
  }
  Turn(const Turn&) = delete;
  Turn& operator=(const Turn&) = delete;

 private:
  IdempotencyKeys& keys_;
  const std::pair<std::int64_t, std::string> key_;
};

Handler IdempotencyKeys::once(OnceHandler handler) {
  return [this, handler = std::move(handler)](const Request& request) { return serve(request, handler, false); };
}

Handler IdempotencyKeys::by_part(OnceHandler handler) {
  return [this, handler = std::move(handler)](const Request& request) { return serve(request, handler, true); };
}

Reply IdempotencyKeys::serve(const Request& request, const OnceHandler& handler, bool by_part) {
  Once once;
  if (!request.idempotency_key) return handler(request, once);
  check_key(*request.idempotency_key);
  once.keys_ = this;
  once.key_ = AnswerKey{request.caller ? request.caller->id : 0, *request.idempotency_key};
  const Turn turn(*this, *once.key_);
  once.request_ = hash_of(request);
  for (const KeptAnswer& answer : find_answers(store_.read(), *once.key_, clock_() - kKeptFor)) {
    if (answer.request != once.request_) {
      throw ContractError("idempotency_mismatch",
                          "This Idempotency-Key came with another request before. Give each request its own.");
    }
    once.kept_.emplace(answer.part, reply_of(answer));
  }
  const std::size_t before = once.kept_.size();
  const bool is_known = before > 0 && !by_part;
  Reply reply = is_known ? *once.kept(0) : handler(request, once);
  if (!by_part && !is_known) {
    if (const Reply* kept = once.kept(0)) {  // what will be given again is given now
      std::string subject = std::move(reply.subject);
      reply = *kept;
      reply.subject = std::move(subject);
    } else if (is_success(reply)) {
      const auto map = request.parameters.find("map");
      once.keep_later(reply, map == request.parameters.end() ? "" : map->second, 0);
    }
  }
  once.store_later();
  if (before > 0 && once.kept_.size() == before) reply.headers.emplace_back(kReplayed, "true");
  return reply;
}

void Once::keep(WriteTransaction& db, const Reply& reply, const std::string& map, std::int64_t part) {
  if (!key_) return;
  const Timestamp at = keys_->clock_();
  const std::optional<MapRow> row = map.empty() ? std::nullopt : find_map(db, map);
  keep_answer(db, *key_,
              {.part = part,
               .request = request_,
               .status = reply.status,
               .headers = header_lines(reply),
               .body = reply.body,
               .map = row ? std::optional(row->id) : std::nullopt,
               .kept_at = at});
  drop_answers(db, at - kKeptFor, kDroppedAtOnce);
  kept_.insert_or_assign(part, reply);
}

void Once::keep_later(Reply reply, const std::string& map, std::int64_t part) {
  if (key_) later_.push_back({std::move(reply), map, part});
}

const Reply* Once::kept(std::int64_t part) const {
  const auto found = kept_.find(part);
  return found == kept_.end() ? nullptr : &found->second;
}

// The effects are there: an answer that cannot be kept is given all the same.
void Once::store_later() {
  if (later_.empty()) return;
  try {
    WriteTransaction db = keys_->store_.write();
    for (const Later& later : later_) keep(db, later.reply, later.map, later.part);
    db.commit();
  } catch (const std::exception& error) {
    spdlog::warn("an answer could not be kept: {}", error.what());
  }
}

}  // namespace mapweld::server
