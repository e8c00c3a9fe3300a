#include "client/client.h"

#include <utility>

#include "client/contract/page.h"
#include "client/image_folder.h"

namespace mapweld::client {
namespace {

using contract::Json;

constexpr const char* kRoot = "/v1";
constexpr const char* kJson = "application/json";
constexpr const char* kDatabase = "application/vnd.sqlite3";

Json parsed(const std::string& body) {
  try {
    return contract::parse_json(body);
  } catch (const contract::ContractError& error) {
    throw UnexpectedAnswer(std::string("The server's answer cannot be read. ") + error.what());
  }
}

template <class T>
T understood(const Json& json) {
  try {
    return json.get<T>();
  } catch (const contract::ContractError& error) {
    throw UnexpectedAnswer(std::string("The server's answer cannot be read. ") + error.what());
  }
}

template <class T>
Answer<T> answer(const std::string& body) {
  Json json = parsed(body);
  T value = understood<T>(json);
  return {std::move(value), std::move(json)};
}

}  // namespace

Client::Client(const std::string& base_url, const ConnectionOptions& options) : connection_(base_url, options) {}

template <class T>
Answer<std::vector<T>> Client::all_pages(const std::vector<std::string>& segments, Query query) {
  query.emplace_back("limit", std::to_string(contract::kMaxPageItems));
  const std::size_t first_page = query.size();
  Answer<std::vector<T>> all;
  all.json = {{"items", Json::array()}, {"next_cursor", nullptr}};
  for (;;) {
    Json json = parsed(connection_.get(path_of(kRoot, segments, query)));
    auto page = understood<contract::Page<T>>(json);
    for (T& item : page.items) all.value.push_back(std::move(item));
    for (Json& item : json["items"]) all.json["items"].push_back(std::move(item));
    if (!page.next_cursor) return all;
    query.resize(first_page);
    query.emplace_back("cursor", *page.next_cursor);
  }
}

Json Client::health() { return parsed(connection_.get("/healthz")); }
Json Client::version() { return parsed(connection_.get("/version")); }

Answer<std::vector<contract::Vocabulary>> Client::vocabularies() {
  return all_pages<contract::Vocabulary>({"vocabularies"});
}

Answer<contract::Map> Client::create_map(const contract::CreateMap& request, const std::string& idempotency_key) {
  return answer<contract::Map>(connection_.post("/v1/maps", contract::dump(request), kJson, idempotency_key));
}
Answer<std::vector<contract::Map>> Client::maps() { return all_pages<contract::Map>({"maps"}); }
Answer<contract::Map> Client::map(const std::string& name) {
  return answer<contract::Map>(connection_.get(path_of(kRoot, {"maps", name})));
}
Answer<contract::Map> Client::change_map(const std::string& name, const contract::ChangeMap& change) {
  return answer<contract::Map>(connection_.patch(path_of(kRoot, {"maps", name}), contract::dump(change), kJson));
}
void Client::delete_map(const std::string& name) { connection_.remove(path_of(kRoot, {"maps", name})); }

void Client::export_map(const std::string& map, bool images, const std::function<void(std::string_view)>& receive) {
  connection_.get(path_of(kRoot, {"maps", map, "export"}, images ? Query{} : Query{{"images", "false"}}), receive);
}
Answer<contract::Map> Client::import_map(const std::filesystem::path& file, const std::optional<std::string>& name) {
  return answer<contract::Map>(
      connection_.post_file(path_of("/v1/maps:import", {}, name ? Query{{"name", *name}} : Query{}), file, kDatabase));
}

Answer<contract::Backup> Client::begin_backup() {
  return answer<contract::Backup>(connection_.post("/v1/backups", "", kJson));
}
Answer<std::vector<contract::Backup>> Client::backups() { return all_pages<contract::Backup>({"backups"}); }
Answer<contract::Backup> Client::backup(std::int64_t id) {
  return answer<contract::Backup>(connection_.get(path_of(kRoot, {"backups", std::to_string(id)})));
}
void Client::backup_content(std::int64_t id, const std::function<void(std::string_view)>& receive) {
  connection_.get(path_of(kRoot, {"backups", std::to_string(id), "content"}), receive);
}
void Client::delete_backup(std::int64_t id) { connection_.remove(path_of(kRoot, {"backups", std::to_string(id)})); }

void Client::set_mask(const std::string& map, const std::string& png_bytes) {
  connection_.put(path_of(kRoot, {"maps", map, "mask"}), png_bytes, std::string(media_type(png_bytes)));
}
std::string Client::mask(const std::string& map) { return connection_.get(path_of(kRoot, {"maps", map, "mask"})); }
void Client::clear_mask(const std::string& map) { connection_.remove(path_of(kRoot, {"maps", map, "mask"})); }

Answer<contract::Upload> Client::upload_image(const std::string& map, const ImageFile& image,
                                              const std::string& idempotency_key) {
  Query query{{"name", image.name}};
  if (image.metadata.camera) query.emplace_back("camera", contract::dump(contract::Json(*image.metadata.camera)));
  if (image.metadata.pose) query.emplace_back("pose", contract::dump(contract::Json(*image.metadata.pose)));
  const std::string path = path_of(kRoot, {"maps", map, "images"}, query);
  return answer<contract::Upload>(
      connection_.post(path, image.bytes, std::string(media_type(image.bytes)), idempotency_key));
}

Answer<contract::Batch> Client::upload_batch(const std::string& map, const std::vector<ImageFile>& images,
                                             const std::string& idempotency_key) {
  std::vector<FormPart> parts;
  parts.reserve(images.size() + 1);
  contract::Json metadata = contract::Json::array();
  bool has_metadata = false;
  for (const ImageFile& image : images) {
    metadata.push_back(image.metadata);
    has_metadata = has_metadata || image.metadata != contract::ImageMetadata{};
  }
  if (has_metadata) parts.push_back({"", kJson, contract::dump(metadata), "metadata"});
  for (const ImageFile& image : images) {
    parts.push_back({image.name, std::string(media_type(image.bytes)), image.bytes});
  }
  auto batch = answer<contract::Batch>(
      connection_.post_form(path_of(kRoot, {"maps", map, "images", "batch"}), parts, idempotency_key));
  if (batch->items.size() != images.size()) {
    throw UnexpectedAnswer("The server answered " + std::to_string(batch->items.size()) + " items to a batch of " +
                           std::to_string(images.size()) + ".");
  }
  return batch;
}

Answer<std::vector<contract::Vertex>> Client::vertices(const std::string& map) {
  return all_pages<contract::Vertex>({"maps", map, "vertices"});
}
Answer<contract::Vertex> Client::vertex(const std::string& map, std::int64_t vertex) {
  return answer<contract::Vertex>(connection_.get(path_of(kRoot, {"maps", map, "vertices", std::to_string(vertex)})));
}
std::string Client::vertex_image(const std::string& map, std::int64_t vertex) {
  return connection_.get(path_of(kRoot, {"maps", map, "vertices", std::to_string(vertex), "image"}));
}
Answer<contract::Deleted> Client::delete_vertex(const std::string& map, std::int64_t vertex) {
  return answer<contract::Deleted>(
      connection_.remove(path_of(kRoot, {"maps", map, "vertices", std::to_string(vertex)})));
}
Answer<contract::Deleted> Client::delete_vertices(const std::string& map, std::int64_t first, std::int64_t last) {
  const Query range{{"from", std::to_string(first)}, {"to", std::to_string(last)}};
  return answer<contract::Deleted>(connection_.remove(path_of(kRoot, {"maps", map, "vertices"}, range)));
}
Answer<contract::Deleted> Client::delete_named(const std::string& map, const std::string& image_name) {
  return answer<contract::Deleted>(
      connection_.remove(path_of(kRoot, {"maps", map, "vertices"}, {{"name", image_name}})));
}
void Client::delete_vertex_image(const std::string& map, std::int64_t vertex) {
  connection_.remove(path_of(kRoot, {"maps", map, "vertices", std::to_string(vertex), "image"}));
}
Answer<contract::Vertex> Client::restore_vertex(const std::string& map, std::int64_t vertex) {
  return answer<contract::Vertex>(
      connection_.post(path_of(kRoot, {"maps", map, "vertices", std::to_string(vertex), "restore"}), "", kJson));
}
Answer<std::vector<contract::IgnoredImage>> Client::ignored(const std::string& map) {
  return all_pages<contract::IgnoredImage>({"maps", map, "ignored"});
}

Answer<contract::Localization> Client::localize(const std::string& map, const std::string& image_bytes,
                                                const LocalizeOptions& options) {
  Query query;
  if (options.limit) query.emplace_back("limit", std::to_string(*options.limit));
  if (options.verified) query.emplace_back("verified", "true");
  if (options.camera_of_map) query.emplace_back("camera", "map");
  if (options.camera) query.emplace_back("camera", contract::dump(contract::Json(*options.camera)));
  return answer<contract::Localization>(connection_.post(path_of(kRoot, {"maps", map, "localize"}, query), image_bytes,
                                                         std::string(media_type(image_bytes))));
}

Answer<std::vector<contract::Edge>> Client::edges(const std::string& map) {
  return all_pages<contract::Edge>({"maps", map, "edges"});
}
contract::Graph Client::graph(const std::string& map) {
  return answer<contract::Graph>(connection_.get(path_of(kRoot, {"maps", map, "graph"}, {{"format", "json"}}))).value;
}
void Client::export_graph(const std::string& map, const std::string& format,
                          const std::function<void(std::string_view)>& receive) {
  connection_.get(path_of(kRoot, {"maps", map, "graph"}, {{"format", format}}), receive);
}
Answer<contract::Quality> Client::quality(const std::string& map) {
  return answer<contract::Quality>(connection_.get(path_of(kRoot, {"maps", map, "quality"})));
}

Answer<contract::Merge> Client::submit_merge(const contract::SubmitMerge& request, const std::string& idempotency_key) {
  return answer<contract::Merge>(connection_.post("/v1/merges", contract::dump(request), kJson, idempotency_key));
}
Answer<std::vector<contract::Merge>> Client::merges(const std::optional<std::string>& state) {
  return all_pages<contract::Merge>({"merges"}, state ? Query{{"state", *state}} : Query{});
}
Answer<contract::Merge> Client::merge(std::int64_t id) {
  return answer<contract::Merge>(connection_.get(path_of(kRoot, {"merges", std::to_string(id)})));
}
Answer<std::vector<contract::CurvePoint>> Client::curve(std::int64_t id) {
  return all_pages<contract::CurvePoint>({"merges", std::to_string(id), "curve"});
}
Answer<std::vector<contract::MergeEdge>> Client::merge_edges(std::int64_t id) {
  return all_pages<contract::MergeEdge>({"merges", std::to_string(id), "edges"});
}
Answer<contract::Pair> Client::merge_pair(std::int64_t id, std::int64_t u, std::int64_t v, bool matches) {
  return pair({"merges", std::to_string(id)}, u, v, matches);
}
Answer<contract::Pair> Client::map_pair(const std::string& map, std::int64_t u, std::int64_t v, bool matches) {
  return pair({"maps", map}, u, v, matches);
}
Answer<contract::Pair> Client::pair(std::vector<std::string> path, std::int64_t u, std::int64_t v, bool matches) {
  path.insert(path.end(), {"pairs", std::to_string(u), std::to_string(v)});
  return answer<contract::Pair>(connection_.get(path_of(kRoot, path, matches ? Query{{"matches", "true"}} : Query{})));
}

Answer<contract::Merge> Client::command_merge(std::int64_t id, const std::string& verb, const std::string& body) {
  return answer<contract::Merge>(connection_.post(path_of(kRoot, {"merges", std::to_string(id), verb}), body, kJson));
}
Answer<contract::Merge> Client::pause_merge(std::int64_t id) { return command_merge(id, "pause", "{}"); }
Answer<contract::Merge> Client::resume_merge(std::int64_t id, const std::optional<contract::Budget>& budget) {
  return command_merge(id, "resume", contract::dump(contract::RunMerge{budget}));
}
Answer<contract::Merge> Client::restart_merge(std::int64_t id, const std::optional<contract::Budget>& budget) {
  return command_merge(id, "restart", contract::dump(contract::RunMerge{budget}));
}
Answer<contract::Merge> Client::cancel_merge(std::int64_t id) { return command_merge(id, "cancel", "{}"); }
void Client::delete_merge(std::int64_t id) { connection_.remove(path_of(kRoot, {"merges", std::to_string(id)})); }

}  // namespace mapweld::client
