#include "server/api/description/schema_book.h"

#include <array>
#include <span>
#include <string_view>

#include "client/contract/merge.h"
#include "client/contract/pair.h"
#include "core/types.h"

namespace mapweld::server {
namespace {

using contract::Json;

// The values that the code lists.
Json listed(const std::string& value) {
  const auto words = [](std::span<const std::string_view> list) {
    Json words = Json::array();
    for (const std::string_view word : list) words.push_back(word);
    return words;
  };
  if (value == "MergeState") return words(contract::kMergeStates);
  if (value == "MergePhase") return words(contract::kMergePhases);
  if (value == "MergeMethod") return words(contract::kMergeMethods);
  if (value == "PairVerdict") return words(contract::kPairVerdicts);
  if (value == "Reason" || value == "UploadReason") {
    Json reasons = Json::array();
    for (int reason = 1; reason <= static_cast<int>(Reason::kAmbiguous); ++reason) {
      reasons.push_back(to_string(static_cast<Reason>(reason)));
    }
    if (value == "UploadReason") reasons.insert(reasons.end(), {"too_similar", "identical"});
    return reasons;
  }
  return nullptr;
}

// Null is allowed too.
Json or_null(Json schema) {
  if (schema.contains("type")) {
    schema["type"] = Json::array({schema["type"], "null"});
    if (schema.contains("enum")) schema["enum"].push_back(nullptr);
    return schema;
  }
  Json either = Json::object();
  if (schema.contains("description")) either["description"] = schema["description"];
  schema.erase("description");
  either["oneOf"] = Json::array({std::move(schema), {{"type", "null"}}});
  return either;
}

// What `words` say goes before what `schema` says, at every level; null takes it away.
void say(Json& schema, const Json& words) {
  for (const auto& [key, said] : words.items()) {
    if (said.is_null()) {
      schema.erase(key);
    } else if (said.is_object() && schema.contains(key) && schema[key].is_object() && !schema[key].contains("$ref")) {
      say(schema[key], said);
    } else {
      schema[key] = said;
    }
  }
  if (words.contains("$ref")) {
    for (const char* replaced : {"type", "format", "minimum"}) schema.erase(replaced);
  }
}

}  // namespace

std::string SchemaBook::last_name(const std::string& qualified) {
  return qualified.substr(qualified.find_last_of(":/") + 1);
}

std::string SchemaBook::page_name(const std::string& item) {
  if (item == "IgnoredImage") return "IgnoredPage";
  if (item == "CurvePoint") return "CurvePage";
  return item + "Page";
}

Json SchemaBook::finished(const std::string& document, const std::string& field, Json type, bool nullable) {
  const Json words = words_.resolved(words_.field(document, field));
  if (words.is_object()) {
    say(type, words);
    enter_values(words);
  }
  return nullable ? or_null(std::move(type)) : type;
}

void SchemaBook::enter_values(const Json& schema) {
  if (!schema.is_structured()) return;
  for (const auto& [key, part] : schema.items()) {
    if (key != "$ref") {
      enter_values(part);
      continue;
    }
    const std::string name = last_name(part.get<std::string>());
    if (schemas_.contains(name)) continue;
    Json value = {{"type", "string"}};
    if (Json words = listed(name); !words.is_null()) value["enum"] = std::move(words);
    Json said = words_.resolved(words_.find({"values", name}));
    if (said.is_object()) {
      if (const auto like = said.find("like"); like != said.end()) {
        value = schemas_[like->get<std::string>()];
        said.erase("like");
      }
      say(value, said);
    }
    schemas_[name] = std::move(value);
  }
}

void SchemaBook::enter(const std::string& name, Json schema) {
  if (const Json description = words_.find({"documents", name, "description"}, true); !description.is_null()) {
    schema["description"] = description;
  }
  schemas_[name] = std::move(schema);
}

Json SchemaBook::reference_to_batch() {
  if (!schemas_.contains("Batch")) {
    schemas_["Batch"] = nullptr;
    const Json either = {{"oneOf", Json::array({reference<contract::Upload>(), reference<contract::Problem>()})}};
    Json schema = {{"type", "object"}, {"properties", Json::object()}, {"required", Json::array({"items"})}};
    schema["properties"]["items"] = finished("Batch", "items", {{"type", "array"}, {"items", either}}, false);
    enter("Batch", std::move(schema));
  }
  return {{"$ref", "#/components/schemas/Batch"}};
}

}  // namespace mapweld::server
