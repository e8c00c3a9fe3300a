#include "server/services/quotas.h"

#include <optional>
#include <string>

#include "client/contract/problem.h"

namespace mapweld::server {
namespace {

void require(std::int64_t wanted, const std::optional<std::int64_t>& max, std::int64_t used, const std::string& of,
             const Caller& caller) {
  if (!max || wanted <= *max) return;
  throw contract::ContractError("quota_exceeded", "The key \"" + caller.name + "\" has " + std::to_string(used) +
                                                      " of " + std::to_string(*max) + " " + of +
                                                      "; this would be more. Delete some, or ask for a larger quota.");
}

}  // namespace

contract::Quota quota_of(const Reader& db, const Caller* caller) {
  contract::Quota quota;
  if (caller == nullptr) return quota;
  const KeyUsage usage = usage_of(db, caller->id);
  quota.key = caller->name;
  quota.images = {usage.images, caller->quota.images};
  quota.bytes = {usage.bytes, caller->quota.bytes};
  quota.queued_merges = {usage.queued_merges, caller->quota.queued_merges};
  return quota;
}

Room::Room(const Reader& db, const Caller* caller) : caller_(caller) {
  if (caller != nullptr && caller->quota.bounds_images()) usage_ = usage_of(db, caller->id);
}

void Room::take_image(std::int64_t bytes) {
  if (caller_ == nullptr) return;
  require(usage_.images + 1, caller_->quota.images, usage_.images, "images", *caller_);
  require(usage_.bytes + bytes, caller_->quota.bytes, usage_.bytes, "bytes of images", *caller_);
  ++usage_.images;
  usage_.bytes += bytes;
}

void require_images_fit(const Reader& db, const Caller* caller) {
  if (caller == nullptr || !caller->quota.bounds_images()) return;
  const KeyUsage usage = usage_of(db, caller->id);
  require(usage.images, caller->quota.images, usage.images, "images", *caller);
  require(usage.bytes, caller->quota.bytes, usage.bytes, "bytes of images", *caller);
}

void take_merge(WriteTransaction& db, const Caller* caller, JobId merge) {
  if (caller == nullptr) return;
  own_merge(db, merge, caller->id);
  const std::int64_t queued = usage_of(db, caller->id).queued_merges;
  require(queued, caller->quota.queued_merges, queued - 1, "merges that wait or run", *caller);
}

std::unique_lock<std::mutex> QuotaTurns::take(const Caller* caller) {
  if (caller == nullptr || !caller->quota.bounds_images()) return {};
  std::mutex* turn = nullptr;
  {
    const std::lock_guard lock(mutex_);
    std::unique_ptr<std::mutex>& own = turns_[caller->id];
    if (!own) own = std::make_unique<std::mutex>();
    turn = own.get();
  }
  return std::unique_lock(*turn);
}

}  // namespace mapweld::server
