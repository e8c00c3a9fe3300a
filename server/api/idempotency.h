// Requests that take effect once, however often they are sent: docs/http-api.md, "Asking once".
//
// A handler hands a Keep to its use case, which calls it in the transaction of the effect: answer and effect are
// committed together, or neither is. What has no such transaction is kept when it is done.
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <mutex>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "schema/answer_store.h"
#include "schema/store.h"
#include "server/http/message.h"
#include "server/services/keep.h"
#include "server/services/times.h"

namespace mapweld::server {

class Once;

// The keys of requests that are under way, and the answers that are kept in the store. Any thread.
class IdempotencyKeys {
 public:
  using Clock = std::function<Timestamp()>;
  // `store` must outlive this.
  explicit IdempotencyKeys(Store& store, Clock clock = now) : store_(store), clock_(std::move(clock)) {}

  using OnceHandler = std::function<Reply(const Request&, Once&)>;
  // A request without a key is passed on. With one that is no key: ContractError invalid_parameter; that came with
  // another request: idempotency_mismatch; of a request under way: idempotency_in_progress. This must outlive the
  // handler that is returned.
  //
  // once: an answer that is kept is given again; that of the handler is kept if it is a success and the handler has not
  // seen to that. by_part: the handler does both for each of its parts.
  Handler once(OnceHandler handler);
  Handler by_part(OnceHandler handler);

 private:
  friend class Once;
  class Turn;
  Reply serve(const Request& request, const OnceHandler& handler, bool by_part);

  Store& store_;
  const Clock clock_;
  std::mutex mutex_;
  std::set<std::pair<std::int64_t, std::string>> under_way_;  // caller and key
};

// One request on its way through its handler.
class Once {
 public:
  // For a use case: `keep` as it is, or empty when the request has no key.
  template <typename Outcome>
  Keep<Outcome> keeps(Keep<Outcome> keep) const {
    return key_ ? std::move(keep) : Keep<Outcome>{};
  }

  // In the transaction of the effect. `map`: of which the reply tells. The reply is then also what is answered now.
  void keep(WriteTransaction& db, const Reply& reply, const std::string& map, std::int64_t part = 0);
  // Of a part that had no effect: when the handler has returned.
  void keep_later(Reply reply, const std::string& map, std::int64_t part);

  // The answer that a part has been given, now or before; null: none yet.
  const Reply* kept(std::int64_t part) const;

 private:
  friend class IdempotencyKeys;
  Once() = default;
  void store_later();

  struct Later {
    Reply reply;
    std::string map;
    std::int64_t part = 0;
  };
  IdempotencyKeys* keys_ = nullptr;
  std::optional<AnswerKey> key_;  // none: nothing is kept
  Sha256 request_{};
  std::map<std::int64_t, Reply> kept_;  // by part
  std::vector<Later> later_;
};

}  // namespace mapweld::server
