#include "client/contract/image.h"

namespace mapweld::contract {

void to_json(Json& json, const Batch& batch) {
  Json items = Json::array();
  for (const BatchItem& item : batch.items) {
    items.push_back(std::visit([](const auto& one) { return detail::encode(one); }, item));
  }
  json = Json::object();
  json["items"] = std::move(items);
}

void from_json(const Json& json, Batch& batch) {
  const detail::Place root;
  if (!json.is_object() || !json.contains("items") || !json["items"].is_array()) {
    detail::throw_wrong_type(root.inside("items"), "an array", json);
  }
  batch.items.clear();
  for (std::size_t i = 0; i < json["items"].size(); ++i) {
    const Json& item = json["items"][i];
    const auto read = [&](auto one) {
      detail::decode(item, one, root.inside("items").at(i), detail::Reading::kAnswer);
      batch.items.emplace_back(std::move(one));
    };
    if (item.is_object() && item.contains("outcome")) {
      read(Upload{});
    } else {
      read(Problem{});
    }
  }
}

}  // namespace mapweld::contract
