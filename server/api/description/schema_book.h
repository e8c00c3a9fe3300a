// The schemas of the contract's documents, made from their fields().
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <tuple>
#include <type_traits>
#include <utility>
#include <variant>
#include <vector>

#include <boost/type_index.hpp>

#include "client/contract/codec.h"
#include "client/contract/image.h"
#include "client/contract/page.h"
#include "server/api/description/words.h"

namespace mapweld::server {

// Who writes documents decides what their schemas demand: answers have every field that they do not leave out when it
// is empty, requests have those that are required and no unknown ones.
enum class Writer : std::uint8_t { kClient, kServer };

class SchemaBook {
 public:
  explicit SchemaBook(Words& words) : words_(words) {}

  // Of what is entered from now on. Enter requests first: a document that both write is then as the client may write
  // it.
  void written_by(Writer writer) { writer_ = writer; }

  // Enters a document, and those in it, unless they are there; a reference to it.
  template <contract::Document T>
  contract::Json reference();
  contract::Json reference_to_batch();
  // Enters the values that a schema refers to.
  void enter_values(const contract::Json& schema);

  // By name: documents, and the values that have a schema of their own.
  const contract::Json& schemas() const { return schemas_; }

  // "Vertex" of contract::Vertex, "VertexPage" of a page of them.
  template <class T>
  static std::string name_of();

 private:
  template <class T>
  contract::Json schema_of();
  template <class Owner, class Value>
  void add_field(contract::Json& schema, const std::string& document, const contract::Field<Owner, Value>& field);
  // What words say of the field, over what its type says.
  contract::Json finished(const std::string& document, const std::string& field, contract::Json type, bool nullable);
  // Enters the schema under its name, with what is said of the document.
  void enter(const std::string& name, contract::Json schema);
  static std::string last_name(const std::string& qualified);
  static std::string page_name(const std::string& item);

  Words& words_;
  Writer writer_ = Writer::kServer;
  contract::Json schemas_ = contract::Json::object();
};

// The SchemaOf of a document.
template <class T>
contract::Json document_schema(SchemaBook& book) {
  if constexpr (std::is_same_v<T, contract::Batch>) {
    return book.reference_to_batch();
  } else {
    return book.reference<T>();
  }
}

namespace detail {
template <class T>
struct PageItem : std::false_type {};
template <class T>
struct PageItem<contract::Page<T>> : std::true_type {
  using Item = T;
};
}  // namespace detail

template <class T>
std::string SchemaBook::name_of() {
  if constexpr (detail::PageItem<T>::value) {
    return page_name(name_of<typename detail::PageItem<T>::Item>());
  } else {
    return last_name(boost::typeindex::type_id<T>().pretty_name());
  }
}

template <contract::Document T>
contract::Json SchemaBook::reference() {
  const std::string name = name_of<T>();
  if (!schemas_.contains(name)) {
    schemas_[name] = nullptr;  // its place, before those in it
    contract::Json schema = {{"type", "object"}, {"properties", contract::Json::object()}};
    std::apply([&](const auto&... described) { (add_field(schema, name, described), ...); }, T::fields());
    if (writer_ == Writer::kClient) schema["additionalProperties"] = false;
    enter(name, std::move(schema));
  }
  return {{"$ref", "#/components/schemas/" + name}};
}

template <class T>
contract::Json SchemaBook::schema_of() {
  if constexpr (contract::detail::IsOptional<T>::value) {
    return schema_of<typename T::value_type>();
  } else if constexpr (contract::detail::IsVector<T>::value) {
    return {{"type", "array"}, {"items", schema_of<typename T::value_type>()}};
  } else if constexpr (std::is_same_v<T, std::map<std::string, std::string>>) {
    return {{"type", "object"}, {"additionalProperties", {{"type", "string"}}}};
  } else if constexpr (contract::Document<T>) {
    return reference<T>();
  } else if constexpr (std::is_same_v<T, contract::Json>) {
    return contract::Json::object();
  } else if constexpr (std::is_same_v<T, bool>) {
    return {{"type", "boolean"}};
  } else if constexpr (std::is_integral_v<T>) {
    // A count or the number of something, unless words say otherwise.
    return {{"type", "integer"}, {"format", sizeof(T) > 4 ? "int64" : "int32"}, {"minimum", 0}};
  } else if constexpr (std::is_floating_point_v<T>) {
    return {{"type", "number"}};
  } else {
    static_assert(std::is_same_v<T, std::string>, "a type that the contract does not know");
    return {{"type", "string"}};
  }
}

template <class Owner, class Value>
void SchemaBook::add_field(contract::Json& schema, const std::string& document,
                           const contract::Field<Owner, Value>& field) {
  using contract::FieldRule;
  const bool omitted = field.rule == FieldRule::kOmittedWhenEmpty;
  const bool by_client = writer_ == Writer::kClient;
  const bool nullable = contract::detail::IsOptional<Value>::value && (by_client || !omitted);
  schema["properties"][field.name] = finished(document, field.name, schema_of<Value>(), nullable);
  if (by_client ? field.rule == FieldRule::kRequired : !omitted) schema["required"].push_back(field.name);
}

}  // namespace mapweld::server
