// The documents of the contract have the fields that docs/openapi.json says they have.
#include <set>
#include <string>
#include <tuple>

#include <gtest/gtest.h>

#include "client/contract/backup.h"
#include "client/contract/graph.h"
#include "client/contract/image.h"
#include "client/contract/map.h"
#include "client/contract/merge.h"
#include "client/contract/pair.h"
#include "client/contract/problem_document.h"
#include "client/contract/quota.h"
#include "client/contract/route.h"
#include "client/contract/vocabulary.h"
#include "server/api/openapi.h"

namespace mapweld::contract {
namespace {

using Names = std::set<std::string>;

template <Document T>
Names fields_of() {
  Names names;
  std::apply([&](const auto&... described) { (names.insert(described.name), ...); }, T::fields());
  return names;
}

// Those that an answer may leave out.
template <Document T>
Names omitted_of() {
  Names names;
  std::apply(
      [&](const auto&... described) {
        ((described.rule == FieldRule::kOmittedWhenEmpty ? void(names.insert(described.name)) : void()), ...);
      },
      T::fields());
  return names;
}

Names keys_of(const Json& object) {
  Names names;
  for (const auto& [key, value] : object.items()) names.insert(key);
  return names;
}

template <Document T>
void expect_fields(const Json& schema, const std::string& name) {
  EXPECT_EQ(keys_of(schema["properties"]), fields_of<T>()) << name;
}

// The same of an answer, which also has everything that is not left out when it is empty.
template <Document T>
void expect_answer(const Json& schema, const std::string& name) {
  expect_fields<T>(schema, name);
  Names always = fields_of<T>();
  for (const std::string& field : omitted_of<T>()) always.erase(field);
  const Names required = schema["required"].get<Names>();
  EXPECT_EQ(required, always) << name;
}

TEST(OpenApi, SchemasHaveTheFieldsOfTheDocuments) {
  const Json document = Json::parse(server::openapi_document());
  const Json& schemas = document["components"]["schemas"];
  expect_answer<Camera>(schemas["Camera"], "Camera");
  expect_answer<Pose>(schemas["Pose"], "Pose");
  expect_answer<RelativePose>(schemas["RelativePose"], "RelativePose");
  expect_answer<EdgeCounts>(schemas["EdgeCounts"], "EdgeCounts");
  expect_answer<Edge>(schemas["Edge"], "Edge");
  expect_answer<Quality>(schemas["Quality"], "Quality");
  expect_answer<Route>(schemas["Route"], "Route");
  expect_answer<Map>(schemas["Map"], "Map");
  expect_answer<Deleted>(schemas["Deleted"], "Deleted");
  expect_answer<Vertex>(schemas["Vertex"], "Vertex");
  expect_answer<IgnoredImage>(schemas["IgnoredImage"], "IgnoredImage");
  expect_answer<Upload>(schemas["Upload"], "Upload");
  expect_answer<UploadEdge>(schemas["Upload"]["properties"]["edges"]["items"], "an upload's edge");
  expect_answer<Localization>(schemas["Localization"], "Localization");
  expect_answer<Merge>(schemas["Merge"], "Merge");
  expect_answer<MemberPair>(schemas["Merge"]["properties"]["pairs"]["items"], "a merge's pair");
  expect_answer<CurvePoint>(schemas["CurvePoint"], "CurvePoint");
  expect_answer<MergeEdge>(schemas["MergeEdge"], "MergeEdge");
  expect_answer<Pair>(schemas["Pair"], "Pair");
  expect_answer<Evidence>(schemas["Pair"]["properties"]["evidence"]["items"], "a pair's evidence");
  expect_answer<Problem>(schemas["Problem"], "Problem");
  expect_answer<Backup>(schemas["Backup"], "Backup");
  expect_answer<Quota>(schemas["Quota"], "Quota");
  expect_answer<Share>(schemas["Share"], "Share");
  expect_answer<Vocabulary>(schemas["Vocabulary"], "Vocabulary");
  expect_fields<MapParameters>(schemas["MapParameters"], "MapParameters");
  expect_fields<CreateMap>(schemas["CreateMap"], "CreateMap");
  expect_fields<ChangeMap>(schemas["ChangeMap"], "ChangeMap");
  expect_fields<MergeParameters>(schemas["MergeParameters"], "MergeParameters");
  expect_fields<SubmitMerge>(schemas["SubmitMerge"], "SubmitMerge");
  expect_fields<RunMerge>(schemas["RunMerge"], "RunMerge");
  expect_fields<Budget>(schemas["Budget"], "Budget");
}

}  // namespace
}  // namespace mapweld::contract
