// Merges as documents of the contract: a thin layer over the merge jobs.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "client/contract/merge.h"
#include "client/contract/page.h"
#include "server/jobs/merge_jobs.h"
#include "server/maps/map_opener.h"
#include "server/services/map_service.h"
#include "server/services/quality_service.h"

namespace mapweld::server {

// Thread-safe. Throws ContractError and MergeJobError for requests that cannot be met, StoreError.
class MergeService {
 public:
  // Everything given must outlive this.
  MergeService(Store& store, MergeJobs& jobs, MapOpener& opener, QualityService& quality)
      : store_(store), jobs_(jobs), opener_(opener), quality_(quality) {}

  // Also quota_exceeded, and forbidden when the caller may not use a member or a map of the merge's name; null: may use
  // all.
  contract::Merge submit(const contract::SubmitMerge& request, const Caller* caller = nullptr,
                         const Keep<contract::Merge>& keep = {});
  // Throws forbidden when the caller may not use the merged map, by whose name a merge goes; no_such_merge.
  void require_use(std::int64_t id, const Caller* caller) const;
  contract::Merge get(std::int64_t id) const;
  contract::Page<contract::Merge> list(const std::optional<std::string>& state, const PageRequest& page,
                                       const Caller* caller = nullptr) const;
  contract::Page<contract::CurvePoint> curve(std::int64_t id, const PageRequest& page) const;
  contract::Page<contract::MergeEdge> edges(std::int64_t id, const PageRequest& page) const;

  contract::Merge pause(std::int64_t id, const Keep<contract::Merge>& keep = {});
  // These let it run, as the caller's, if there is one: quota_exceeded.
  contract::Merge resume(std::int64_t id, const contract::RunMerge& request, const Keep<contract::Merge>& keep = {},
                         const Caller* caller = nullptr);
  contract::Merge restart(std::int64_t id, const contract::RunMerge& request, const Keep<contract::Merge>& keep = {},
                          const Caller* caller = nullptr);
  contract::Merge cancel(std::int64_t id, const Keep<contract::Merge>& keep = {});
  void remove(std::int64_t id);

 private:
  VoteRule rule_of(const contract::SubmitMerge& request) const;
  contract::Merge present(const MergeStatus& status) const;
  // To be kept as it is shown.
  Keep<MergeStatus> presented(const Keep<contract::Merge>& keep) const;
  // The same of one that is being queued, which is the caller's then.
  Keep<MergeStatus> taken(const Keep<contract::Merge>& keep, const Caller* caller) const;

  Store& store_;
  MergeJobs& jobs_;
  MapOpener& opener_;
  QualityService& quality_;
};

}  // namespace mapweld::server
