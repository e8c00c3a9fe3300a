#include "tests/benchmark/stored_pair.h"

#include <algorithm>
#include <fstream>
#include <stdexcept>
#include <utility>

#include "core/fingerprint.h"
#include "core/geometry/portable_math.h"
#include "schema/maps/map_store.h"
#include "schema/maps/vertex_store.h"
#include "schema/store.h"

namespace mapweld::benchmark_support {

MergeInput load_stored_maps(const std::filesystem::path& data_folder, std::span<const std::string> names) {
  Store store(data_folder / "mapweld.db", {.read_only = true});
  const ReadTransaction db = store.read();
  MergeInput input;
  std::vector<std::uint32_t> sizes;
  std::vector<std::shared_ptr<const AppearanceVector>> vectors;
  for (const std::string& name : names) {
    const auto map = find_map(db, name);
    if (!map) throw std::runtime_error(data_folder.string() + " has no map " + name);
    const auto base = static_cast<std::uint32_t>(vectors.size());
    for (const Edge& e : load_edges(db, load_layout(db, map->id))) {
      input.inner_edges.push_back({VertexId{base + to_index(e.u)}, VertexId{base + to_index(e.v)}, e.weight});
    }
    for (AppearanceVector& image : load_appearances(db, map->id, map->vocabulary, VertexId{0}, map->vertices)) {
      vectors.push_back(std::make_shared<const AppearanceVector>(std::move(image)));
    }
    sizes.push_back(map->vertices);
  }
  input.members = number_members(sizes);
  input.appearances = std::make_shared<AppearanceTable>(std::move(vectors));
  return input;
}

MergeInput load_stored_pair(const std::filesystem::path& data_folder, const std::string& first,
                            const std::string& second) {
  const std::string names[]{first, second};
  return load_stored_maps(data_folder, names);
}

RememberingVerifier::RememberingVerifier(std::shared_ptr<const PairVerifier> verifier, std::filesystem::path file)
    : verifier_(std::move(verifier)), file_(std::move(file)) {
  std::ifstream stream(file_, std::ios::binary);
  for (Verdict v; stream.read(reinterpret_cast<char*>(&v), sizeof(v));) verdicts_.emplace(v.pair, v);
  stored_ = verdicts_.size();
}

RememberingVerifier::~RememberingVerifier() {
  if (file_.empty() || stored_ == verdicts_.size()) return;
  std::ofstream stream(file_, std::ios::binary | std::ios::trunc);
  for (const auto& [pair, v] : verdicts_) stream.write(reinterpret_cast<const char*>(&v), sizeof(v));
}

std::uint64_t RememberingVerifier::content_of(const AppearanceVector& image) const {
  const auto [entry, is_new] = contents_.try_emplace(&image, 0);
  if (is_new) entry->second = content_hash(image);
  return entry->second;
}

Verification RememberingVerifier::verify(const AppearanceVector& a, const AppearanceVector& b) const {
  const std::uint64_t of_a = content_of(a), of_b = content_of(b);
  Fingerprint hash;
  hash.add(std::min(of_a, of_b));
  hash.add(std::max(of_a, of_b));
  const auto [entry, is_new] = verdicts_.try_emplace(hash.value());
  Verdict& known = entry->second;
  if (is_new) {
    const Verification v = verifier_->verify(a, b);
    known = {hash.value(), static_cast<std::uint16_t>(v.matches), static_cast<std::uint16_t>(v.inliers),
             static_cast<std::uint8_t>(v.accepted ? 1 : 0), static_cast<std::uint8_t>(v.reason)};
  }
  Verification result;
  result.accepted = known.accepted != 0;
  result.reason = static_cast<Reason>(known.reason);
  result.matches = known.matches;
  result.inliers = known.inliers;
  return result;
}

}  // namespace mapweld::benchmark_support
