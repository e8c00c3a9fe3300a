#include "server/api/description/describe.h"

#include <algorithm>
#include <cctype>
#include <map>
#include <string_view>
#include <utility>

#include "client/contract/camera.h"
#include "client/contract/problem_document.h"
#include "server/api/description/route_codes.h"
#include "server/api/description/schema_book.h"
#include "server/api/description/texts.h"
#include "server/api/description/words.h"

namespace mapweld::server {
namespace {

using contract::Code;
using contract::Json;

Json reference(const std::string& kind, const std::string& name) {
  return {{"$ref", "#/components/" + kind + "/" + name}};
}

std::vector<std::string> parameters_in(const std::string& pattern) {
  std::vector<std::string> names;
  for (std::size_t at = 0; (at = pattern.find('{', at)) != std::string::npos;) {
    const std::size_t end = pattern.find('}', at);
    names.push_back(pattern.substr(at + 1, end - at - 1));
    at = end;
  }
  return names;
}

class Describer {
 public:
  ApiDescription describe(const std::vector<Route>& routes);

 private:
  Json operation(const Route& route);
  Json parameters(const Route& route);
  Json parameter(const std::string& operation, const std::string& name, const char* in);
  Json contents(const std::string& operation, const std::vector<Content>& contents);
  Json answer(const Route& route, const AnswerDescription& answer);
  void add_problems(const Route& route, Json& responses);
  Json header(const std::string& name);
  // Of a document: what words give, of a page one of its items.
  void enter_example(const std::string& document);

  Words words_{words_text()};
  SchemaBook book_{words_};
  Json parameters_ = Json::object();  // and the other components
  Json headers_ = Json::object();
  Json responses_ = Json::object();
  Json examples_ = Json::object();
};

Json Describer::header(const std::string& name) {
  if (!headers_.contains(name)) headers_[name] = words_.resolved(words_.find({"headers", name}));
  return reference("headers", name);
}

Json Describer::parameter(const std::string& operation, const std::string& name, const char* in) {
  Json said = words_.resolved(words_.parameter(operation, name));
  Json made = {{"name", name}, {"in", in}};
  if (std::string_view(in) == "path") made["required"] = true;
  if (said.is_object()) made.update(said);
  book_.enter_values(made);
  const Json own = words_.find({"operations", operation, "parameters", name}, true);
  if (!own.is_null()) return made;
  parameters_[name] = std::move(made);
  return reference("parameters", name);
}

Json Describer::parameters(const Route& route) {
  Json list = Json::array();
  const std::string& id = route.says.operation;
  for (const std::string& name : parameters_in(route.pattern)) list.push_back(parameter(id, name, "path"));
  for (const std::string& name : route.query) list.push_back(parameter(id, name, "query"));
  if (route.takes_idempotency_key()) list.push_back(parameter(id, "Idempotency-Key", "header"));
  for (const AnswerDescription& answer : route.says.answers) {
    if (answer.status == 304) list.push_back(parameter(id, "If-None-Match", "header"));
    if (answer.status == 206) {
      for (const char* name : {"Range", "If-Range"}) list.push_back(parameter(id, name, "header"));
    }
    for (const Content& content : answer.contents) {
      if (content.media_type == "text/event-stream") list.push_back(parameter(id, "Last-Event-ID", "header"));
    }
  }
  return list;
}

void Describer::enter_example(const std::string& document) {
  if (examples_.contains(document)) return;
  Json example;
  if (document.ends_with("Page")) {
    const std::string item = book_.schemas()[document]["properties"]["items"]["items"]["$ref"].get<std::string>();
    const std::string name = item.substr(item.rfind('/') + 1);
    example = {{"items", Json::array({words_.find({"documents", name, "example"})})}, {"next_cursor", nullptr}};
  } else {
    example = words_.find({"documents", document, "example"});
  }
  examples_[document] = {{"value", std::move(example)}};
}

Json Describer::contents(const std::string& operation, const std::vector<Content>& contents) {
  Json made = Json::object();
  for (const Content& content : contents) {
    Json& one = made[content.media_type] = Json::object();
    if (content.schema) {
      one["schema"] = content.schema(book_);
      const std::string at = one["schema"]["$ref"].get<std::string>();
      const std::string document = at.substr(at.rfind('/') + 1);
      enter_example(document);
      one["examples"][document] = reference("examples", document);
    } else if (const Json said = words_.find({"operations", operation, "contents", content.media_type}, true);
               !said.is_null()) {
      one = said;
    }
  }
  return made;
}

Json Describer::answer(const Route& route, const AnswerDescription& answer) {
  const std::string status = std::to_string(answer.status);
  const std::string& id = route.says.operation;
  if (answer.status == 304) {
    if (!responses_.contains("NotModified")) {
      responses_["NotModified"] = {{"description", "What the client has, by its If-None-Match, is what there is."},
                                   {"headers", {{"ETag", header("ETag")}, {"X-Request-Id", header("X-Request-Id")}}}};
    }
    return reference("responses", "NotModified");
  }
  Json made = {{"description", words_.find({"operations", id, "answers", status})}};
  for (const std::string& name : answer.headers) made["headers"][name] = header(name);
  const bool tagged = std::ranges::any_of(route.says.answers, [](const auto& other) { return other.status == 304; });
  if (tagged) made["headers"]["ETag"] = header("ETag");
  if (route.takes_idempotency_key()) made["headers"]["Idempotent-Replayed"] = header("Idempotent-Replayed");
  made["headers"]["X-Request-Id"] = header("X-Request-Id");
  if (!answer.contents.empty()) made["content"] = contents(id, answer.contents);
  return made;
}

void Describer::add_problems(const Route& route, Json& responses) {
  std::map<int, std::vector<Code>> by_status;
  for (const Code code : codes_of(route)) by_status[code.status()].push_back(code);
  for (const auto& [status, codes] : by_status) {
    std::string name;
    std::string description;
    Json content = {{"schema", document_schema<contract::Problem>(book_)}};
    Json listed = Json::array();
    for (const Code code : codes) {
      const std::string word(code.word());
      name += (name.empty() ? "" : "-") + word;
      description += (description.empty() ? "`" : " `") + word + "`: " + std::string(code.title()) + ".";
      listed.push_back(word);
      content["examples"][word] = reference("examples", word);
      examples_[word] = {{"summary", code.title()},
                         {"value", contract::problem_of(code, std::string(code.title()) + ".", "5fafc65f-000003")}};
    }
    content["schema"] = {{"allOf", Json::array({content["schema"], {{"properties", {{"code", {{"enum", listed}}}}}}})}};
    Json response = {{"description", description}, {"headers", {{"X-Request-Id", header("X-Request-Id")}}}};
    if (status == 401) response["headers"]["WWW-Authenticate"] = header("WWW-Authenticate");
    const bool under_way = std::ranges::find(codes, Code("idempotency_in_progress")) != codes.end();
    if (status == 429 || status == 503 || under_way) response["headers"]["Retry-After"] = header("Retry-After");
    response["content"]["application/problem+json"] = std::move(content);
    responses_[name] = std::move(response);
    responses[std::to_string(status)] = reference("responses", name);
  }
}

Json Describer::operation(const Route& route) {
  const std::string& id = route.says.operation;
  Json made = {{"operationId", id},
               {"tags", Json::array({words_.find({"operations", id, "tag"})})},
               {"summary", words_.find({"operations", id, "summary"})}};
  const Json more = words_.find({"operations", id, "description"}, true);
  made["description"] = (more.is_null() ? "" : more.get<std::string>() + " ") +
                        (route.role == Role::kAnybody ? "Asks for no key."
                                                      : "Where keys exist, asks for one of the role " +
                                                            std::string(to_string(route.role)) + " or more.");
  made["security"] = Json::array();
  if (route.role != Role::kAnybody) made["security"].push_back({{"key", Json::array({to_string(route.role)})}});
  if (Json list = parameters(route); !list.empty()) made["parameters"] = std::move(list);
  if (!route.says.takes.empty()) {
    made["requestBody"] = {{"required", route.body == BodyRule::kRequired || route.body == BodyRule::kFile},
                           {"content", contents(id, route.says.takes)}};
  }
  Json responses = Json::object();
  for (const AnswerDescription& one : route.says.answers) responses[std::to_string(one.status)] = answer(route, one);
  add_problems(route, responses);
  made["responses"] = std::move(responses);
  return made;
}

ApiDescription Describer::describe(const std::vector<Route>& routes) {
  book_.written_by(Writer::kClient);
  for (const SchemaOf& in_parameters : {&document_schema<contract::Camera>, &document_schema<contract::Pose>}) {
    in_parameters(book_);
  }
  for (const Route& route : routes) {
    for (const Content& content : route.says.takes) {
      if (content.schema) content.schema(book_);
    }
  }
  book_.written_by(Writer::kServer);
  Json paths = Json::object();
  for (const Route& route : routes) {
    std::string method = route.method;
    std::ranges::transform(method, method.begin(), [](unsigned char c) { return std::tolower(c); });
    paths[route.pattern][method] = operation(route);
  }
  ApiDescription api;
  api.document = {{"openapi", "3.1.0"},
                  {"info", words_.find({"info"})},
                  {"servers", words_.find({"servers"})},
                  {"tags", words_.find({"tags"})},
                  {"paths", std::move(paths)},
                  {"components",
                   {{"securitySchemes", words_.find({"securitySchemes"})},
                    {"parameters", std::move(parameters_)},
                    {"headers", std::move(headers_)},
                    {"schemas", book_.schemas()},
                    {"responses", std::move(responses_)},
                    {"examples", std::move(examples_)}}}};
  api.faults = words_.faults();
  return api;
}

}  // namespace

ApiDescription describe_api(const std::vector<Route>& routes) { return Describer().describe(routes); }

}  // namespace mapweld::server
