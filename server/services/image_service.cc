#include "server/services/image_service.h"

#include <exception>
#include <utility>
#include <variant>

namespace mapweld::server {

UploadOutcome ImageService::upload(const std::string& map, const ImageUpload& image,
                                   const std::optional<std::string>& map_uuid, const Keep<StoredUpload>& keep,
                                   const Caller* caller) {
  std::vector<BatchOutcome> outcomes = upload_batch(map, {image}, map_uuid, keep, caller);
  if (const auto* error = std::get_if<std::exception_ptr>(&outcomes.front())) std::rethrow_exception(*error);
  return std::get<UploadOutcome>(std::move(outcomes.front()));
}

std::vector<BatchOutcome> ImageService::upload_batch(const std::string& map, const std::vector<ImageUpload>& images,
                                                     const std::optional<std::string>& map_uuid,
                                                     const Keep<StoredUpload>& keep, const Caller* caller) {
  context_.refuse_when_stopping();
  return UploadSession(context_, map, map_uuid, keep, caller).run(images);
}

}  // namespace mapweld::server
