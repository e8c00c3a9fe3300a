// How good a map is (paper, section IV).
#pragma once

#include <cstdint>
#include <map>
#include <mutex>
#include <string>

#include "client/contract/graph.h"
#include "schema/maps/map_layout.h"
#include "schema/maps/map_store.h"
#include "schema/store.h"

namespace mapweld::server {

// Thread-safe. Remembers the answers for maps that have not changed since.
class QualityService {
 public:
  explicit QualityService(Store& store) : store_(store) {}

  // Of the confirmed edges. Throws ContractError no_such_map, StoreError.
  contract::Quality quality(const std::string& map);

 private:
  struct Known {
    std::uint64_t revision = 0;
    contract::Quality quality;
  };

  Store& store_;
  std::mutex mutex_;
  std::map<MapId, Known> known_;
};

// How many vertices of each direct member have an inter-map edge, and the maximum matching of these edges.
struct Joins {
  std::vector<contract::Joined> members;
  std::int64_t independent = 0;
};
Joins joins_of(const Reader& db, const MapRow& map, const MapLayout& layout);

}  // namespace mapweld::server
