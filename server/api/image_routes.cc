#include <algorithm>
#include <map>
#include <string>
#include <variant>
#include <vector>

#include "client/contract/camera.h"
#include "client/contract/image.h"
#include "client/contract/names.h"
#include "server/api/api.h"
#include "server/api/cursors.h"
#include "server/api/description/contents.h"
#include "server/api/replies.h"
#include "server/http/multipart.h"
#include "server/http/problem.h"
#include "server/services/cameras.h"
#include "server/services/times.h"

namespace mapweld::server {
namespace {

using contract::ContractError;

constexpr std::int64_t kMinWidthPx = 16;  // of pictures that are made smaller
constexpr std::int64_t kMaxWidthPx = 4096;

// Bodies that are JSON have the same bound.
constexpr std::size_t kMaxJsonBytes = 1 << 20;

// JSON beside the body, named `name`.
contract::Json json_of_text(std::string_view text, const std::string& name) {
  if (text.size() > kMaxJsonBytes) throw ContractError("invalid_parameter", "\"" + name + "\" is too long.");
  try {
    return contract::parse_json(text);
  } catch (const ContractError& error) {
    throw ContractError("invalid_parameter", "\"" + name + "\" is no JSON: " + error.detail());
  }
}

// A document of JSON in a query parameter.
template <class Document>
std::optional<Document> document_in_query(const Request& request, const char* name) {
  const auto text = request.query.text(name);
  if (!text) return std::nullopt;
  Document document = contract::read_request<Document>(json_of_text(*text, name));
  contract::check(document, name);
  return document;
}

void add(Provenance& provenance, const std::optional<contract::Camera>& camera,
         const std::optional<contract::Pose>& pose) {
  if (camera) provenance.camera = camera_to_row(*camera);
  if (pose) provenance.pose = pose_to_row(*pose);
}

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
  add(provenance, document_in_query<contract::Camera>(request, "camera"),
      document_in_query<contract::Pose>(request, "pose"));
  return provenance;
}

Reply upload_reply(const std::string& map, const UploadOutcome& outcome) {
  Reply reply = json_reply(outcome.created ? 201 : 200, outcome.upload);
  if (outcome.created) {
    reply.headers.emplace_back("Location", "/v1/maps/" + map + "/vertices/" + std::to_string(*outcome.upload.vertex));
  }
  return reply;
}

Reply upload(ImageService& images, const Request& request, Once& once) {
  ImageUpload image;
  const auto name = request.query.text("name");
  if (name) {
    contract::check_image_name(*name);
    image.name = *name;
  }
  image.bytes = request.body_bytes();
  image.provenance = provenance_in_query(request);
  const std::string& map = request.parameter("map");
  const auto keep = once.keeps<StoredUpload>(
      [&](WriteTransaction& db, const StoredUpload& stored) { once.keep(db, upload_reply(map, stored.outcome), map); });
  return upload_reply(map, images.upload(map, image, request.query.text("map_uuid"), keep, request.caller.get()));
}

// What a batch says of its images beside their bytes: of each in order; of none when it says nothing.
std::vector<contract::ImageMetadata> metadata_of(const Part& part) {
  const contract::Json json = json_of_text(part.content, "metadata");
  if (!json.is_array() || json.size() > contract::kMaxBatchImages) {
    throw ContractError("invalid_parameter", "\"metadata\" must be an array, with one entry an image.");
  }
  std::vector<contract::ImageMetadata> all;
  for (std::size_t i = 0; i < json.size(); ++i) {
    all.push_back(json[i].is_null() ? contract::ImageMetadata{}
                                    : contract::read_request<contract::ImageMetadata>(json[i]));
    contract::check(all.back(), "metadata[" + std::to_string(i) + "]");
  }
  return all;
}

bool is_metadata(const Part& part) { return part.name == "metadata" && part.file_name.empty(); }

// An image that was stored under the request's key before is not uploaded again.
Reply upload_batch(ImageService& images, const Request& request, Once& once) {
  const std::string boundary = multipart_boundary(request.content_type);
  std::vector<Part> parts = parse_multipart(request.body, boundary, contract::kMaxBatchImages + 1);
  std::optional<std::vector<contract::ImageMetadata>> metadata;
  if (const auto part = std::ranges::find_if(parts, is_metadata); part != parts.end()) {
    metadata = metadata_of(*part);
    parts.erase(part);
  }
  if (parts.empty()) throw ContractError("empty_body", "The batch has no image.");
  const std::string& map = request.parameter("map");
  if (parts.size() > contract::kMaxBatchImages) {
    throw ContractError("too_many_images",
                        "A batch has at most " + std::to_string(contract::kMaxBatchImages) + " images.");
  }
  if (metadata && metadata->size() != parts.size()) {
    throw ContractError("invalid_parameter",
                        "\"metadata\" must have one entry an image: " + std::to_string(parts.size()) + ", not " +
                            std::to_string(metadata->size()) + ".");
  }
  const auto camera = document_in_query<contract::Camera>(request, "camera");
  std::vector<ImageUpload> uploads;
  std::vector<std::int64_t> part_of;  // each upload
  for (std::size_t i = 0; i < parts.size(); ++i) {
    const auto part = static_cast<std::int64_t>(i);
    if (once.kept(part) != nullptr) continue;
    ImageUpload image;
    add(image.provenance, camera, {});
    if (metadata) {
      const contract::ImageMetadata& own = (*metadata)[i];
      add(image.provenance, own.camera, own.pose);
    }
    image.name = parts[i].file_name;
    image.bytes = {reinterpret_cast<const std::uint8_t*>(parts[i].content.data()), parts[i].content.size()};
    image.provenance.sequence = request.query.text("sequence");
    uploads.push_back(std::move(image));
    part_of.push_back(part);
  }
  std::map<std::int64_t, BatchOutcome> outcomes;
  if (!uploads.empty()) {
    const auto keep = once.keeps<StoredUpload>([&](WriteTransaction& db, const StoredUpload& stored) {
      once.keep(db, upload_reply(map, stored.outcome), map, part_of[stored.place]);
    });
    auto uploaded = images.upload_batch(map, uploads, request.query.text("map_uuid"), keep, request.caller.get());
    for (std::size_t i = 0; i < uploaded.size(); ++i) outcomes.emplace(part_of[i], std::move(uploaded[i]));
  }
  contract::Batch batch;
  for (std::size_t i = 0; i < parts.size(); ++i) {
    const auto part = static_cast<std::int64_t>(i);
    const auto now = outcomes.find(part);
    if (now != outcomes.end() && std::holds_alternative<std::exception_ptr>(now->second)) {
      batch.items.emplace_back(problem_of(std::get<std::exception_ptr>(now->second), request.request_id));
    } else if (const Reply* kept = once.kept(part)) {
      batch.items.emplace_back(contract::parse_json(kept->body).get<contract::Upload>());
    } else {
      auto& outcome = std::get<UploadOutcome>(now->second);
      once.keep_later(upload_reply(map, outcome), map, part);
      batch.items.emplace_back(std::move(outcome.upload));
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
  query.by_camera_of_map = request.query.text("camera") == "map";
  if (!query.by_camera_of_map) query.camera = document_in_query<contract::Camera>(request, "camera");
  return json_reply(200, localization.localize(request.parameter("map"), query));
}

}  // namespace

void add_image_routes(Router& router, const Services& services) {
  router.add({.method = "POST",
              .pattern = "/v1/maps/{map}/images",
              .role = Role::kWrite,
              .body = BodyRule::kRequired,
              .query = {"name", "captured_at", "sequence", "index", "camera", "pose", "map_uuid"},
              .says = {.operation = "uploadImage",
                       .takes = pictures(),
                       .answers = {answers<contract::Upload>(201, {"Location"}), answers<contract::Upload>(200)},
                       .codes = {"invalid_name", "name_taken", "wrong_map", "map_is_merged", "image_too_large",
                                 "unsupported_image", "undecodable_image", "quota_exceeded"}},
              .handler = services.idempotency.once([&images = services.images](const Request& request, Once& once) {
                return upload(images, request, once);
              })});
  router.add({.method = "POST",
              .pattern = "/v1/maps/{map}/images/batch",
              .role = Role::kWrite,
              .body = BodyRule::kRequired,
              .query = {"sequence", "camera", "map_uuid"},
              .says = {.operation = "uploadImages",
                       .takes = {{"multipart/form-data"}},
                       .answers = {answers<contract::Batch>(200)},
                       .codes = {"malformed_multipart", "wrong_map", "map_is_merged", "too_many_images"}},
              .handler = services.idempotency.by_part([&images = services.images](const Request& request, Once& once) {
                return upload_batch(images, request, once);
              })});
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
              .query = {"limit", "verified", "camera"},
              .says = {.operation = "localize",
                       .takes = pictures(),
                       .answers = {answers<contract::Localization>(200)},
                       .codes = {"image_too_large", "unsupported_image", "undecodable_image"}},
              .handler = [&localization = services.localization](const Request& request) {
                return localize(localization, request);
              }});
}

}  // namespace mapweld::server
