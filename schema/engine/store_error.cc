#include "schema/engine/store_error.h"

namespace mapweld {

std::string_view to_string(StoreErrorKind kind) {
  switch (kind) {
    case StoreErrorKind::kNoSpace:
      return "no_space";
    case StoreErrorKind::kBusy:
      return "busy";
    case StoreErrorKind::kCorrupt:
      return "corrupt";
    case StoreErrorKind::kForeignDatabase:
      return "foreign_database";
    case StoreErrorKind::kNewerVersion:
      return "newer_version";
    case StoreErrorKind::kOlderVersion:
      return "older_version";
    case StoreErrorKind::kNotFound:
      return "not_found";
    case StoreErrorKind::kFolderInUse:
      return "folder_in_use";
    case StoreErrorKind::kNoPermission:
      return "no_permission";
    case StoreErrorKind::kConstraint:
      return "constraint";
    case StoreErrorKind::kNoResources:
      return "no_resources";
    case StoreErrorKind::kGone:
      return "gone";
    case StoreErrorKind::kIo:
      return "io";
    case StoreErrorKind::kInternal:
      return "internal";
  }
  return "internal";
}

}  // namespace mapweld
