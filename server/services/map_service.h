// Maps: creating, showing and deleting them, and reading what is in them.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "client/contract/graph.h"
#include "client/contract/image.h"
#include "client/contract/map.h"
#include "client/contract/page.h"
#include "schema/maps/map_layout.h"
#include "schema/maps/map_store.h"
#include "schema/store.h"
#include "server/access/caller.h"
#include "server/maps/map_opener.h"
#include "server/services/keep.h"
#include "server/services/vocabulary_service.h"

namespace mapweld::server {

struct PageRequest {
  std::size_t limit = contract::kDefaultPageItems;
  std::optional<std::string> cursor;
};

struct StoredImage {
  std::string media_type;
  std::string bytes;
  std::string sha256;  // hexadecimal
};

// Thread-safe. Throws ContractError for what is not there or not allowed, StoreError. Who asks is given where a request
// names maps elsewhere than in its path, which is the gate's; null: everything is allowed.
class MapService {
 public:
  // Deletes the merge with this id, its merged map with it.
  using RemoveMerge = std::function<void(std::int64_t merge)>;

  // Everything given must outlive this.
  MapService(Store& store, MapOpener& opener, const VocabularyService& vocabularies, RemoveMerge remove_merge)
      : store_(store), opener_(opener), vocabularies_(vocabularies), remove_merge_(std::move(remove_merge)) {}

  // invalid_name, invalid_parameter, no_such_vocabulary; name_taken, also for a uuid that another map has;
  // forbidden.
  contract::Map create(const contract::CreateMap& request, const Caller* caller = nullptr,
                       const Keep<contract::Map>& keep = {});
  contract::Map get(const std::string& name) const;
  contract::Map get(const Reader& db, const std::string& name) const;
  // What the request leaves out stays as it is. invalid_name, name_taken, invalid_parameter; immutable_parameter for
  // what the images that are stored were taken in by; forbidden for a name that the caller may not use.
  contract::Map change(const std::string& name, const contract::ChangeMap& request, const Caller* caller = nullptr);
  // Those that the caller may use.
  contract::Page<contract::Map> list(const PageRequest& page, const Caller* caller = nullptr) const;
  // Deleting a merged map deletes its merge. map_in_use while a merged map names it.
  void remove(const std::string& name);

  // Of a merged map: in its own numbers, with the member that each vertex lives in. `name`: only those named so.
  contract::Page<contract::Vertex> vertices(const std::string& map, const std::optional<std::string>& name,
                                            const PageRequest& page) const;
  contract::Vertex vertex(const std::string& map, std::uint32_t vertex) const;  // no_such_vertex
  contract::Vertex vertex(const Reader& db, const std::string& map, std::uint32_t vertex) const;
  StoredImage image(const std::string& map, std::uint32_t vertex) const;  // no_such_vertex, no_such_image
  contract::Page<contract::IgnoredImage> ignored(const std::string& map, const PageRequest& page) const;

  struct EdgeQuery {
    std::uint32_t min_inliers = 0;
    std::optional<bool> inter = {};      // only inter-map or only inner edges
    std::optional<bool> confirmed = {};  // only confirmed edges, or only those that the alias guard withholds
  };
  contract::Page<contract::Edge> edges(const std::string& map, const EdgeQuery& query, const PageRequest& page) const;

 private:
  contract::Map describe(const Reader& db, const MapRow& map) const;

  Store& store_;
  MapOpener& opener_;
  const VocabularyService& vocabularies_;
  const RemoveMerge remove_merge_;
};

}  // namespace mapweld::server
