#include "client/contract/image.h"
#include "client/contract/names.h"
#include "server/api/api.h"
#include "server/api/cursors.h"
#include "server/api/description/contents.h"
#include "server/api/replies.h"
#include "server/http/multipart.h"
#include "server/http/problem.h"
#include "server/services/times.h"

namespace mapweld::server {
namespace {

using contract::ContractError;

constexpr std::int64_t kMinWidthPx = 16;  // of pictures that are made smaller
constexpr std::int64_t kMaxWidthPx = 4096;

Provenance provenance_in_query(const Request& request) {
  Provenance provenance;
  if (const auto text = request.query.text("captured_at")) {
    provenance.captured_at = parse_rfc3339(*text);
    if (!provenance.captured_at) {
      throw ContractError("invalid_parameter", "\"captured_at\" must be a time like 2026-11-23T10:00:00Z (RFC 3339).");
    }
  }
  provenance.sequence = request.query.text("sequence");
  if (provenance.sequence && !contract::is_image_name(*provenance.sequence)) {
    throw ContractError("invalid_parameter",
                        "\"sequence\" must be 1 to 255 bytes of UTF-8 without control characters.");
  }
  provenance.index = request.query.integer("index", 0, INT64_MAX);
  return provenance;
}

Reply upload(ImageService& images, const Request& request) {
  ImageUpload image;
  const auto name = request.query.text("name");
  if (name) {
    contract::check_image_name(*name);
    image.name = *name;
  }
  image.bytes = request.body_bytes();
  image.provenance = provenance_in_query(request);
  const UploadOutcome outcome = images.upload(request.parameter("map"), image, request.query.text("map_uuid"));
  Reply reply = json_reply(outcome.created ? 201 : 200, outcome.upload);
  if (outcome.created) {
    reply.headers.emplace_back(
        "Location", "/v1/maps/" + request.parameter("map") + "/vertices/" + std::to_string(*outcome.upload.vertex));
  }
  return reply;
}

Reply upload_batch(ImageService& images, const Request& request) {
  const std::string boundary = multipart_boundary(request.content_type);
  const std::vector<Part> parts = parse_multipart(request.body, boundary, contract::kMaxBatchImages);
  if (parts.empty()) throw ContractError("empty_body", "The batch has no image.");
  std::vector<ImageUpload> uploads;
  for (const Part& part : parts) {
    ImageUpload image;
    image.name = part.file_name;
    image.bytes = {reinterpret_cast<const std::uint8_t*>(part.content.data()), part.content.size()};
    image.provenance.sequence = request.query.text("sequence");
    uploads.push_back(std::move(image));
  }
  contract::Batch batch;
  for (BatchOutcome& outcome : images.upload_batch(request.parameter("map"), uploads, request.query.text("map_uuid"))) {
    if (const auto* error = std::get_if<std::exception_ptr>(&outcome)) {
      batch.items.emplace_back(problem_of(*error, request.request_id));
    } else {
      batch.items.emplace_back(std::move(std::get<UploadOutcome>(outcome).upload));
    }
  }
  return json_reply(200, batch);
}

Reply read_back(const Services& services, const Request& request) {
  const auto vertex = number_in_path<std::uint32_t>(request, "vertex", "no_such_vertex");
  const auto width_px = request.query.integer("width", kMinWidthPx, kMaxWidthPx);
  Reply reply = image_reply(services.maps.image(request.parameter("map"), vertex));
  if (!width_px) return reply;
  reply.etag.insert(reply.etag.size() - 1, "-" + std::to_string(*width_px));
  if (request.knows(reply.etag)) return reply;
  const std::vector<std::uint8_t> smaller = services.decoder.shrink(
      {reinterpret_cast<const std::uint8_t*>(reply.body.data()), reply.body.size()}, static_cast<int>(*width_px));
  if (!smaller.empty()) reply.body.assign(smaller.begin(), smaller.end());
  return reply;
}

Reply localize(LocalizeService& localization, const Request& request) {
  LocalizeQuery query;
  query.image = request.body_bytes();
  query.limit = static_cast<std::size_t>(request.query.integer("limit", 1, contract::kMaxPageItems).value_or(5));
  query.verified_only = request.query.boolean("verified").value_or(false);
  return json_reply(200, localization.localize(request.parameter("map"), query));
}

}  // namespace

void add_image_routes(Router& router, const Services& services) {
  router.add({.method = "POST",
              .pattern = "/v1/maps/{map}/images",
              .role = Role::kWrite,
              .body = BodyRule::kRequired,
              .query = {"name", "captured_at", "sequence", "index", "map_uuid"},
              .says = {.operation = "uploadImage",
                       .takes = pictures(),
                       .answers = {answers<contract::Upload>(201, {"Location"}), answers<contract::Upload>(200)},
                       .codes = {"invalid_name", "name_taken", "wrong_map", "map_is_merged", "image_too_large",
                                 "unsupported_image", "undecodable_image"}},
              .handler = [&images = services.images](const Request& request) { return upload(images, request); }});
  router.add(
      {.method = "POST",
       .pattern = "/v1/maps/{map}/images/batch",
       .role = Role::kWrite,
       .body = BodyRule::kRequired,
       .query = {"sequence", "map_uuid"},
       .says = {.operation = "uploadImages",
                .takes = {{"multipart/form-data"}},
                .answers = {answers<contract::Batch>(200)},
                .codes = {"malformed_multipart", "wrong_map", "map_is_merged", "too_many_images"}},
       .handler = [&images = services.images](const Request& request) { return upload_batch(images, request); }});
  router.add({.method = "GET",
              .pattern = "/v1/maps/{map}/vertices/{vertex}/image",
              .role = Role::kRead,
              .query = {"width"},
              .says = {.operation = "getImage",
                       .answers = {{200, pictures()}, answers_not_modified()},
                       .codes = {"no_such_image"}},
              .handler = [services](const Request& request) { return read_back(services, request); }});
  router.add({.method = "GET",
              .pattern = "/v1/maps/{map}/ignored",
              .role = Role::kRead,
              .query = list_query(),
              .says = {.operation = "listIgnored", .answers = {answers_page<contract::IgnoredImage>()}},
              .handler = [&maps = services.maps, cursors = Cursors(services.store)](const Request& request) {
                return cursors.reply(
                    request, [&](const PageRequest& page) { return maps.ignored(request.parameter("map"), page); });
              }});
  router.add({.method = "POST",
              .pattern = "/v1/maps/{map}/localize",
              .role = Role::kRead,
              .body = BodyRule::kRequired,
              .query = {"limit", "verified"},
              .says = {.operation = "localize",
                       .takes = pictures(),
                       .answers = {answers<contract::Localization>(200)},
                       .codes = {"image_too_large", "unsupported_image", "undecodable_image"}},
              .handler = [&localization = services.localization](const Request& request) {
                return localize(localization, request);
              }});
}

}  // namespace mapweld::server
