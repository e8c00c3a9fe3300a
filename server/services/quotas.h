// What callers may have, and whether there is room for more (docs/operations.md, "Quotas"). What nobody's key came with
// is nobody's, and unbounded.
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <mutex>

#include "client/contract/quota.h"
#include "schema/ownership_store.h"
#include "schema/store.h"
#include "server/access/caller.h"

namespace mapweld::server {

contract::Quota quota_of(const Reader& db, const Caller* caller);

// What is left to a caller, counted down in memory.
class Room {
 public:
  Room(const Reader& db, const Caller* caller);
  // Takes what one more image needs. Throws ContractError quota_exceeded, and takes nothing, when it is not there.
  void take_image(std::int64_t bytes);

 private:
  const Caller* caller_;
  KeyUsage usage_;
};

// In the transaction that has just brought something: throws quota_exceeded, to undo it, when it was too much.
void require_images_fit(const Reader& db, const Caller* caller);
// Makes a merge that has just been queued the caller's; throws quota_exceeded when it is one too many.
void take_merge(WriteTransaction& db, const Caller* caller, JobId merge);

// Uploads that are decided upon before they are stored take turns where a quota bounds them. Thread-safe.
class QuotaTurns {
 public:
  // Nothing for who has no quota of images or bytes.
  std::unique_lock<std::mutex> take(const Caller* caller);

 private:
  std::mutex mutex_;
  std::map<std::int64_t, std::unique_ptr<std::mutex>> turns_;  // by key; as many as keys with a quota
};

}  // namespace mapweld::server
