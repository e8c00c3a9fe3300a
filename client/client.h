// The client library: docs/http-api.md as C++ functions.
//
//   mapweld::client::Client server("http://127.0.0.1:8080");
//   server.create_map({.name = "lab-a"});
//   mapweld::client::upload_directory(server, {.map = "lab-a", .directory = "lap-1"});  // client/upload.h
//   auto found = server.localize("lab-a", image_bytes);
//   if (found->status == "localized") std::cout << found->matches[0].name;
//
// Every function asks the server once (lists: once a page) and throws ServerProblem when it says no, ConnectionError
// when there is no answer, UnexpectedAnswer when the answer is not the contract's (client/errors.h). Nothing is tried
// again; what that would mean is said where it matters. A POST that is sent again with the idempotency key that it had
// takes effect once.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "client/connection.h"
#include "client/contract/backup.h"
#include "client/contract/graph.h"
#include "client/contract/image.h"
#include "client/contract/json.h"
#include "client/contract/map.h"
#include "client/contract/merge.h"
#include "client/contract/pair.h"
#include "client/contract/vocabulary.h"
#include "client/errors.h"

namespace mapweld::client {

// An answer, understood and as it was sent. `json` holds fields that this client does not know, too; for a list it is
// one page with all the items.
template <class T>
struct Answer {
  T value;
  contract::Json json;
  const T* operator->() const { return &value; }
  const T& operator*() const& { return value; }
  T operator*() && { return std::move(value); }
};

struct ImageFile {
  std::string name;
  std::string bytes;  // JPEG or PNG
  contract::ImageMetadata metadata = {};
};

struct LocalizeOptions {
  std::optional<int> limit;  // most matches in the answer; absent: the server's default, 5
  bool verified = false;     // only verified matches
  // Which camera took the image: then matches tell how it stands to theirs. Or that of the map.
  std::optional<contract::Camera> camera = {};
  bool camera_of_map = false;
};

// Not thread-safe: it is one connection. A second thread makes a second client.
class Client {
 public:
  // Does not connect yet. Throws std::invalid_argument for what is not a server's address.
  explicit Client(const std::string& base_url, const ConnectionOptions& options = {});
  const std::string& base_url() const { return connection_.base_url(); }

  contract::Json health();
  contract::Json version();

  Answer<std::vector<contract::Vocabulary>> vocabularies();

  Answer<contract::Map> create_map(const contract::CreateMap& request, const std::string& idempotency_key = {});
  Answer<std::vector<contract::Map>> maps();
  Answer<contract::Map> map(const std::string& name);
  // Gives it another name or other labels, or changes parameters that may change.
  Answer<contract::Map> change_map(const std::string& name, const contract::ChangeMap& change);
  void delete_map(const std::string& name);

  // A plain map as one file, handed on in pieces; `images`: with the images' bytes.
  void export_map(const std::string& map, bool images, const std::function<void(std::string_view)>& receive);
  // Makes a map of such a file, under its own name or another. Throws std::system_error when it cannot be read.
  Answer<contract::Map> import_map(const std::filesystem::path& file, const std::optional<std::string>& name = {});

  // Begins a copy of the whole server; it is in state "running" until it is made.
  Answer<contract::Backup> begin_backup();
  Answer<std::vector<contract::Backup>> backups();
  Answer<contract::Backup> backup(std::int64_t id);
  void backup_content(std::int64_t id, const std::function<void(std::string_view)>& receive);
  void delete_backup(std::int64_t id);

  // A PNG, white where the map's images are used; for what is uploaded or localized from then on.
  void set_mask(const std::string& map, const std::string& png_bytes);
  std::string mask(const std::string& map);  // the PNG as it was sent; ServerProblem no_such_mask
  void clear_mask(const std::string& map);

  // Uploads are safe to repeat: the same name with the same bytes gets the first outcome again.
  Answer<contract::Upload> upload_image(const std::string& map, const ImageFile& image,
                                        const std::string& idempotency_key = {});
  // At most contract::kMaxBatchImages, whose names have none of " \ %. The items stand in the order of `images`.
  Answer<contract::Batch> upload_batch(const std::string& map, const std::vector<ImageFile>& images,
                                       const std::string& idempotency_key = {});

  Answer<std::vector<contract::Vertex>> vertices(const std::string& map);
  Answer<contract::Vertex> vertex(const std::string& map, std::int64_t vertex);
  std::string vertex_image(const std::string& map, std::int64_t vertex);  // the stored bytes
  // A deleted vertex shows nowhere until it is restored, if it was not purged meanwhile. Of a range, which includes
  // `last`, those that are there.
  Answer<contract::Deleted> delete_vertex(const std::string& map, std::int64_t vertex);
  Answer<contract::Deleted> delete_vertices(const std::string& map, std::int64_t first, std::int64_t last);
  Answer<contract::Deleted> delete_named(const std::string& map, const std::string& image_name);
  void delete_vertex_image(const std::string& map, std::int64_t vertex);  // its bytes alone, for good
  Answer<contract::Vertex> restore_vertex(const std::string& map, std::int64_t vertex);
  Answer<std::vector<contract::IgnoredImage>> ignored(const std::string& map);
  Answer<contract::Localization> localize(const std::string& map, const std::string& image_bytes,
                                          const LocalizeOptions& options = {});

  Answer<std::vector<contract::Edge>> edges(const std::string& map);
  contract::Graph graph(const std::string& map);
  // The graph as the server writes it: "json", "graphml", "dot" or "csv", handed on in pieces.
  void export_graph(const std::string& map, const std::string& format,
                    const std::function<void(std::string_view)>& receive);
  Answer<contract::Quality> quality(const std::string& map);

  Answer<contract::Merge> submit_merge(const contract::SubmitMerge& request, const std::string& idempotency_key = {});
  Answer<std::vector<contract::Merge>> merges(const std::optional<std::string>& state = {});
  Answer<contract::Merge> merge(std::int64_t id);
  Answer<std::vector<contract::CurvePoint>> curve(std::int64_t id);
  Answer<std::vector<contract::MergeEdge>> merge_edges(std::int64_t id);
  // Of two vertices of the merged map, or of any map, in either order; `matches`: with the matches that held.
  Answer<contract::Pair> merge_pair(std::int64_t id, std::int64_t u, std::int64_t v, bool matches = false);
  Answer<contract::Pair> map_pair(const std::string& map, std::int64_t u, std::int64_t v, bool matches = false);
  Answer<contract::Merge> pause_merge(std::int64_t id);
  Answer<contract::Merge> resume_merge(std::int64_t id, const std::optional<contract::Budget>& budget = {});
  Answer<contract::Merge> restart_merge(std::int64_t id, const std::optional<contract::Budget>& budget = {});
  Answer<contract::Merge> cancel_merge(std::int64_t id);
  void delete_merge(std::int64_t id);

 private:
  template <class T>
  Answer<std::vector<T>> all_pages(const std::vector<std::string>& segments, Query query = {});
  Answer<contract::Pair> pair(std::vector<std::string> path, std::int64_t u, std::int64_t v, bool matches);
  Answer<contract::Merge> command_merge(std::int64_t id, const std::string& verb, const std::string& body);

  Connection connection_;
};

}  // namespace mapweld::client
