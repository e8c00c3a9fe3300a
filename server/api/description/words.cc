#include "server/api/description/words.h"

#include <cctype>

namespace mapweld::server {
namespace {

using contract::Json;

std::string joined(const std::vector<std::string>& path) {
  std::string text;
  for (const std::string& step : path) text += (text.empty() ? "" : ".") + step;
  return text;
}

// The things of words.json that are asked for one by one.
void list_things(const Json& words, std::set<std::string>& things) {
  const auto list = [&](const Json& parent, const std::string& section) {
    if (!parent.contains(section)) return std::vector<std::string>();
    std::vector<std::string> names;
    for (const auto& [name, unused] : parent[section].items()) names.push_back(name);
    return names;
  };
  for (const char* section : {"values", "headers", "parameters", "fields"}) {
    for (const std::string& name : list(words, section)) things.insert(std::string(section) + "." + name);
  }
  for (const char* section : {"operations", "documents"}) {
    for (const std::string& name : list(words, section)) {
      const std::string thing = std::string(section) + "." + name;
      for (const auto& [part, value] : words[section][name].items()) {
        const bool listed = part == "parameters" || part == "answers" || part == "contents" || part == "fields";
        if (!listed) things.insert(thing + "." + part);
        if (!listed) continue;
        for (const auto& [key, unused] : value.items()) things.insert(thing + "." + part + "." + key);
      }
    }
  }
}

}  // namespace

Words::Words(std::string_view text) : words_(Json::parse(text)) {}

const Json* Words::look_up(const std::vector<std::string>& path) const {
  const Json* at = &words_;
  for (const std::string& step : path) {
    const auto found = at->find(step);
    if (found == at->end()) return nullptr;
    at = &*found;
  }
  return at;
}

Json Words::find(const std::vector<std::string>& path, bool optional) {
  const Json* found = look_up(path);
  if (found) {
    used_.insert(joined(path));
    return *found;
  }
  if (!optional) missing_.insert(joined(path));
  return nullptr;
}

Json Words::field(const std::string& document, const std::string& name) {
  const std::vector<std::string> own = {"documents", document, "fields", name};
  return look_up(own) || !look_up({"fields", name}) ? find(own) : find({"fields", name});
}

Json Words::parameter(const std::string& operation, const std::string& name) {
  const std::vector<std::string> own = {"operations", operation, "parameters", name};
  return look_up(own) || !look_up({"parameters", name}) ? find(own) : find({"parameters", name});
}

Json Words::resolved(Json schema) {
  if (schema.is_array()) {
    for (Json& part : schema) part = resolved(std::move(part));
  }
  if (!schema.is_object()) return schema;
  Json result = Json::object();
  for (auto& [key, part] : schema.items()) {
    if (key != "is") {
      result[key] = key == "example" || key == "examples" || key == "default" ? part : resolved(std::move(part));
      continue;
    }
    const std::string name = part.get<std::string>();
    const Json value = find({"values", name});
    if (std::isupper(static_cast<unsigned char>(name[0]))) {
      result["$ref"] = "#/components/schemas/" + name;
    } else if (value.is_object()) {
      for (const auto& [inner, said] : value.items()) result[inner] = said;
    }
  }
  return result;
}

std::vector<std::string> Words::faults() const {
  std::vector<std::string> faults;
  for (const std::string& path : missing_) faults.push_back("missing: " + path);
  std::set<std::string> things;
  list_things(words_, things);
  for (const std::string& thing : things) {
    if (!used_.contains(thing)) faults.push_back("left over: " + thing);
  }
  return faults;
}

}  // namespace mapweld::server
