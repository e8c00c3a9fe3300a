#include "tests/server/support/described_api.h"

#include <algorithm>
#include <utility>

#include <valijson/adapters/nlohmann_json_adapter.hpp>
#include <valijson/schema.hpp>
#include <valijson/schema_parser.hpp>
#include <valijson/validation_results.hpp>
#include <valijson/validator.hpp>

#include "server/api/description/describe.h"

namespace mapweld::test {
namespace {

using nlohmann::json;
using valijson::adapters::NlohmannJsonAdapter;

// No object of these schemas may have other fields than those that it names. Parts of an allOf stay open: another part
// names the rest. A format is one of strings, also where null is allowed; the library looks for it in both.
void prepare(json& schema) {
  if (!schema.is_structured()) return;
  for (json& part : schema) prepare(part);
  if (!schema.is_object()) return;
  if (schema.contains("properties") && !schema.contains("additionalProperties") &&
      schema.value("type", json()) == "object") {
    schema["additionalProperties"] = false;
  }
  if (schema.contains("format") && schema.value("type", json()).is_array()) {
    json of_string = {{"type", schema["type"][0]}, {"format", schema["format"]}};
    schema.erase("format");
    schema["anyOf"] = json::array({std::move(of_string), {{"type", "null"}}});
  }
}

std::string media_type(const std::string& content_type) { return content_type.substr(0, content_type.find(';')); }

bool is_json(const std::string& type) { return type == "application/json" || type == "application/problem+json"; }

// Headers that clients act on; the others are HTTP's own.
bool is_told(const std::string& header) {
  for (const char* told : {"Accept-Ranges", "Content-Disposition", "Content-Range", "ETag", "Idempotent-Replayed",
                           "Location", "Retry-After", "WWW-Authenticate", "X-Request-Id"}) {
    if (header == told) return true;
  }
  return false;
}

std::string lower(std::string text) {
  std::transform(text.begin(), text.end(), text.begin(), ::tolower);
  return text;
}

}  // namespace

struct DescribedApi::Prepared {
  valijson::Schema schema;
};

DescribedApi::DescribedApi(const std::vector<server::Route>& routes)
    : document_(json::parse(server::describe_api(routes).document.dump())),
      prepared_components_(document_["components"]) {
  for (const server::Route& route : routes) router_.add(route);
  prepare(prepared_components_["schemas"]);
}

DescribedApi::~DescribedApi() = default;

const json& DescribedApi::resolve(const json& node) const {
  return node.contains("$ref") ? document_.at(json::json_pointer(node["$ref"].get<std::string>().substr(1))) : node;
}

std::vector<std::string> DescribedApi::faults(const json& schema, const json& value) const {
  const std::lock_guard lock(mutex_);
  std::unique_ptr<Prepared>& prepared = prepared_[schema.dump()];
  if (!prepared) {
    prepared = std::make_unique<Prepared>();
    json root = {{"allOf", json::array({schema})}, {"components", prepared_components_}};
    prepare(root["allOf"]);
    valijson::SchemaParser().populateSchema(NlohmannJsonAdapter(root), prepared->schema);
  }
  valijson::Validator validator;
  valijson::ValidationResults results;
  std::vector<std::string> faults;
  if (validator.validate(prepared->schema, NlohmannJsonAdapter(value), &results)) return faults;
  for (const auto& error : results) {
    std::string where;
    for (const std::string& step : error.context) where += step;
    faults.push_back(where + ": " + error.description);
  }
  return faults;
}

void DescribedApi::check_body(const json& contents, const std::string& type, const std::string& body,
                              std::vector<std::string>& said) const {
  const auto content = contents.find(media_type(type));
  if (content == contents.end()) {
    said.push_back("media type " + type);
    return;
  }
  if (!is_json(content.key()) || !content->contains("schema") || body.empty()) return;
  const json value = json::parse(body, nullptr, false);
  if (value.is_discarded()) {
    said.push_back("a body that is not JSON: " + body);
    return;
  }
  for (const std::string& fault : faults((*content)["schema"], value)) said.push_back(fault);
  if (!said.empty()) said.back() += "\n  in " + body.substr(0, 500);
}

std::vector<std::string> DescribedApi::undescribed(const Exchange& exchange) const {
  std::vector<std::string> said;
  const std::string path = exchange.path.substr(0, exchange.path.find('?'));
  const server::Router::Match match = router_.match(exchange.method, path);
  if (!match.route) {  // whatever is answered where nothing is
    if (media_type(exchange.type) == "application/problem+json") {
      const json problem = {{"$ref", "#/components/schemas/Problem"}};
      said = faults(problem, json::parse(exchange.reply, nullptr, false));
    }
    return said;
  }
  const json& operation = document_["paths"].at(match.route->pattern).at(lower(match.route->method));
  const json& responses = operation["responses"];
  const auto response = responses.find(std::to_string(exchange.status));
  if (response == responses.end()) {
    said.push_back("status " + std::to_string(exchange.status));
    return said;
  }
  if (exchange.status == 304) return said;
  const json& answer = resolve(*response);
  for (const std::string& name : exchange.headers) {
    if (is_told(name) && !answer["headers"].contains(name)) said.push_back("header " + name);
  }
  const json contents = answer.value("content", json::object());
  if (!exchange.type.empty() || !exchange.reply.empty()) check_body(contents, exchange.type, exchange.reply, said);
  if (exchange.status < 300 && !exchange.request.empty() && operation.contains("requestBody")) {
    const json& taken = operation["requestBody"]["content"];
    if (taken.contains("application/json")) check_body(taken, "application/json", exchange.request, said);
  }
  return said;
}

}  // namespace mapweld::test
