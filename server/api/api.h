// The paths of docs/http-api.md: each handler reads its request, calls a service and writes the answer down.
#pragma once

#include <functional>
#include <memory>
#include <string>

#include "server/api/idempotency.h"
#include "server/copies/backup_service.h"
#include "server/copies/map_transfer.h"
#include "server/events/event_hub.h"
#include "server/http/router.h"
#include "server/metrics/metrics.h"
#include "server/services/image_service.h"
#include "server/services/localize_service.h"
#include "server/services/map_service.h"
#include "server/services/mask_service.h"
#include "server/services/merge_service.h"
#include "server/services/quality_service.h"
#include "server/services/removal_service.h"
#include "server/services/vocabulary_service.h"

namespace mapweld::server {

// What the handlers call. All of it must outlive the router.
struct Services {
  Store& store;
  Metrics& metrics;
  VocabularyService& vocabularies;
  MapService& maps;
  MaskService& masks;
  ImageService& images;
  LocalizeService& localization;
  QualityService& quality;
  RemovalService& removals;
  MergeService& merges;
  ImageDecoder& decoder;
  EventHub& events;
  BackupService& backups;
  MapTransfer& transfer;
  IdempotencyKeys& idempotency;
  std::function<bool()> ready;  // the server takes requests and can make maps
};

// The whole API.
Router make_router(const Services& services);

// Its parts.
// `description`: the text of openapi.json, filled in before anybody asks.
void add_system_routes(Router& router, const Services& services, std::shared_ptr<const std::string> description);
void add_docs_routes(Router& router);
void add_transfer_routes(Router& router, const Services& services);
void add_vocabulary_routes(Router& router, const Services& services);
void add_map_routes(Router& router, const Services& services);
void add_mask_routes(Router& router, const Services& services);
void add_image_routes(Router& router, const Services& services);
void add_backup_routes(Router& router, const Services& services);
void add_removal_routes(Router& router, const Services& services);
void add_event_routes(Router& router, const Services& services);
void add_merge_routes(Router& router, const Services& services);

}  // namespace mapweld::server
