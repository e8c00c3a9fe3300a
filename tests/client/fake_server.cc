#include "tests/client/fake_server.h"

#include <algorithm>
#include <regex>

#include "client/image_folder.h"

namespace mapweld::testing {
namespace {

using contract::Json;

constexpr std::size_t kPage = 3;  // small, so that lists have pages

void answer(httplib::Response& response, int status, const Json& body) {
  response.status = status;
  response.set_content(contract::dump(body), status < 400 ? "application/json" : "application/problem+json");
}

void answer_problem(httplib::Response& response, contract::Code code, const std::string& detail) {
  answer(response, code.status(), contract::problem_of(code, detail, "r1"));
}

}  // namespace

FakeServer::FakeServer() {
  server_.set_tcp_nodelay(true);
  // Not a pre-routing handler: that would leave a request's body unread on the connection.
  const auto handler = [this](const httplib::Request& request, httplib::Response& response) {
    if (!answer_scripted(request, response)) answer_as_a_server(request, response);
  };
  server_.Get(".*", handler);
  server_.Post(".*", handler);
  server_.Put(".*", handler);
  server_.Patch(".*", handler);
  server_.Delete(".*", handler);
  port_ = server_.bind_to_any_port("127.0.0.1");
  thread_ = std::thread([this] { server_.listen_after_bind(); });
  while (!server_.is_running()) std::this_thread::yield();
}

FakeServer::~FakeServer() {
  server_.stop();
  thread_.join();
}

void FakeServer::script(const std::string& method_and_path, int status, const std::string& body) {
  const std::lock_guard lock(mutex_);
  scripted_[method_and_path] = {status, {body}, 0};
}
void FakeServer::script(const std::string& method_and_path, int status, const Json& body) {
  script(method_and_path, status, contract::dump(body));
}
void FakeServer::script_problem(const std::string& method_and_path, contract::Code code, const std::string& detail) {
  script(method_and_path, code.status(), Json(contract::problem_of(code, detail, "r1")));
}
void FakeServer::script_sequence(const std::string& method_and_path, std::vector<Json> bodies) {
  const std::lock_guard lock(mutex_);
  Scripted& scripted = scripted_[method_and_path] = {};
  for (const Json& body : bodies) scripted.bodies.push_back(contract::dump(body));
}

void FakeServer::break_after_storing(int count) {
  const std::lock_guard lock(mutex_);
  to_break_ = count;
}
void FakeServer::be_busy(int count) {
  const std::lock_guard lock(mutex_);
  to_be_busy_ = count;
}
void FakeServer::take_at_most(std::size_t images) {
  const std::lock_guard lock(mutex_);
  most_images_ = images;
}

std::vector<FakeImage> FakeServer::images(const std::string& map) const {
  const std::lock_guard lock(mutex_);
  const auto found = maps_.find(map);
  return found == maps_.end() ? std::vector<FakeImage>{} : found->second;
}
std::vector<std::string> FakeServer::requests() const {
  const std::lock_guard lock(mutex_);
  return requests_;
}
std::vector<std::string> FakeServer::bodies() const {
  const std::lock_guard lock(mutex_);
  return bodies_;
}
std::vector<std::string> FakeServer::authorizations() const {
  const std::lock_guard lock(mutex_);
  return authorizations_;
}
std::vector<std::string> FakeServer::idempotency_keys() const {
  const std::lock_guard lock(mutex_);
  return idempotency_keys_;
}
std::size_t FakeServer::requests_of(const std::string& beginning) const {
  const auto all = requests();
  return static_cast<std::size_t>(
      std::count_if(all.begin(), all.end(), [&](const std::string& r) { return r.rfind(beginning, 0) == 0; }));
}

bool FakeServer::answer_scripted(const httplib::Request& request, httplib::Response& response) {
  const std::lock_guard lock(mutex_);
  requests_.push_back(request.method + " " + request.target);
  bodies_.push_back(request.body);
  authorizations_.push_back(request.get_header_value("Authorization"));
  idempotency_keys_.push_back(request.get_header_value("Idempotency-Key"));
  const auto found = scripted_.find(request.method + " " + request.path);
  if (found == scripted_.end()) return false;
  Scripted& scripted = found->second;
  response.status = scripted.status;
  response.set_content(scripted.bodies[std::min(scripted.next++, scripted.bodies.size() - 1)], "application/json");
  return true;
}

void FakeServer::answer_as_a_server(const httplib::Request& request, httplib::Response& response) {
  static const std::regex kPath(R"(/v1/maps/([^/]+)/(images/batch|images|vertices|ignored))");
  std::smatch match;
  if (!std::regex_match(request.path, match, kPath)) {
    answer_problem(response, "no_such_path", "There is nothing here.");
  } else if (request.method == "POST" && match[2] == "images/batch") {
    std::vector<std::pair<std::string, std::string>> files;
    for (const auto& [field, file] : request.files) files.emplace_back(file.filename, file.content);
    answer_upload(match[1], files, true, response);
  } else if (request.method == "POST") {
    answer_upload(match[1], {{request.get_param_value("name"), request.body}}, false, response);
  } else {
    Json items = Json::array();
    for (const FakeImage& image : images(match[1])) {
      if (image.ignored == (match[2] == "ignored")) items.push_back({{"name", image.name}, {"sha256", image.sha256}});
    }
    answer_page(request, items, response);
  }
}

contract::BatchItem FakeServer::store(const std::string& map, const std::string& name, const std::string& bytes) {
  if (bytes.rfind("bad", 0) == 0) return contract::problem_of("undecodable_image", "The image is truncated.", "r1");
  std::vector<FakeImage>& images = maps_[map];
  for (const FakeImage& image : images) {
    if (image.name == name && image.bytes != bytes) {
      return contract::problem_of("name_taken", "The map has another image of this name.", "r1");
    }
  }
  const bool known = std::any_of(images.begin(), images.end(), [&](const auto& image) { return image.name == name; });
  const bool ignored = bytes.rfind("dup", 0) == 0;
  if (!known) images.push_back({name, bytes, ignored, client::sha256_hex(bytes)});
  contract::Upload upload;
  upload.outcome = ignored ? "ignored" : "inserted";
  upload.name = name;
  if (ignored) upload.reason = "too_similar";
  return upload;
}

void FakeServer::answer_upload(const std::string& map, const std::vector<std::pair<std::string, std::string>>& files,
                               bool batch, httplib::Response& response) {
  const std::lock_guard lock(mutex_);
  if (to_be_busy_ > 0) {
    --to_be_busy_;
    answer_problem(response, "busy", "Come back later.");
    return;
  }
  if (files.size() > most_images_) {
    answer_problem(response, "body_too_large", "The body is too large.");
    return;
  }
  contract::Batch outcome;
  for (const auto& [name, bytes] : files) outcome.items.push_back(store(map, name, bytes));
  if (to_break_ > 0) {
    --to_break_;
    response.set_content_provider(1000, "application/json", [](std::size_t, std::size_t, httplib::DataSink&) {
      return false;  // ends the connection
    });
    return;
  }
  if (batch) {
    answer(response, 200, outcome);
  } else if (const auto* problem = std::get_if<contract::Problem>(&outcome.items[0])) {
    answer(response, problem->status, *problem);
  } else {
    answer(response, 201, std::get<contract::Upload>(outcome.items[0]));
  }
}

void FakeServer::answer_page(const httplib::Request& request, const Json& items, httplib::Response& response) {
  const std::size_t begin = request.has_param("cursor") ? std::stoul(request.get_param_value("cursor")) : 0;
  const std::size_t end = std::min(items.size(), begin + kPage);
  Json page = {{"items", Json::array()}, {"next_cursor", nullptr}};
  for (std::size_t i = begin; i < end; ++i) page["items"].push_back(items[i]);
  if (end < items.size()) page["next_cursor"] = std::to_string(end);
  answer(response, 200, page);
}

}  // namespace mapweld::testing
