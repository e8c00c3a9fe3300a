#include "tests/server/jobs/stored_toy_maps.h"

#include <utility>
#include <vector>

#include "core/merge/make_merger.h"
#include "core/merge/merge_options.h"
#include "core/merge/run.h"
#include "schema/maps/map_store.h"
#include "schema/maps/vertex_store.h"
#include "schema/merges/merge_state_store.h"

namespace mapweld::test {

void store_toy_maps(Store& store, const ToyWorld& world, const std::string& first, const std::string& second) {
  std::vector<std::string> names{first, second};
  while (names.size() < world.sizes.size()) names.emplace_back(1, static_cast<char>('a' + names.size()));
  VocabularyId vocabulary{};
  if (const auto known = find_vocabulary(store.read(), "words")) {
    vocabulary = known->id;
  } else {
    vocabulary = add_vocabulary(store, "words");
  }
  WriteTransaction db = store.write();
  for (std::size_t m = 0; m < world.sizes.size(); ++m) insert_map(db, new_map(names[m], vocabulary));
  db.commit();
  store_toy_vertices(store, world, names, world.sizes);
}

void store_toy_vertices(Store& store, const ToyWorld& world, const std::vector<std::string>& names,
                        const std::vector<std::uint32_t>& counts) {
  const MergeInput input = make_toy_merge(world);
  WriteTransaction db = store.write();
  const VerifierId verifier = test_verifier(db);
  for (std::size_t m = 0; m < names.size(); ++m) {
    const MapRow map = *find_map(db, names[m]);
    const std::vector<VertexId>& vertices = input.members[m].vertices;
    for (std::uint32_t i = map.vertices; i < counts[m]; ++i) {
      std::vector<NewEdge> edges;
      for (const Edge& e : input.inner_edges) {
        if (e.v != vertices[i]) continue;
        NewEdge edge;
        edge.u = VertexId{to_index(e.u) - to_index(vertices.front())};
        edge.votes = e.weight;
        edge.verification.accepted = true;
        edge.verification.matches = edge.verification.inliers = static_cast<int>(e.weight);
        edges.push_back(edge);
      }
      const AppearanceVector image = *input.appearances->appearances(vertices[i]);
      const std::string name = std::to_string(to_index(vertices[i]));
      insert_vertex(db, map.id, map.vocabulary, new_image(name, image), image, edges, verifier);
    }
  }
  db.commit();
}

server::MergeRequest request_of(const ToyWorld& world, const std::string& name) {
  server::MergeRequest request;
  for (std::size_t m = 0; m < world.sizes.size(); ++m) request.maps.emplace_back(1, static_cast<char>('a' + m));
  request.name = name;
  request.method = world.method;
  request.seed = world.seed;
  request.parameters.min_votes = world.min_votes;
  request.parameters.votes = world.votes;
  return request;
}

MergeState uninterrupted(const ToyWorld& world) {
  const auto merger = make_merger(make_toy_merge(world));
  run(*merger, {});
  return merger->state();
}

MergeState stored_state(Store& store, std::int64_t job) { return load_merge_state(store.read(), JobId{job}).value(); }

server::MergeJobOptions job_options(const std::shared_ptr<const PairVerifier>& verifier) {
  server::MergeJobOptions options;
  options.verifier = [verifier](const VerifierOptions&) { return verifier; };
  return options;
}

std::vector<std::string_view> methods_with_one_candidate_set() {
  std::vector<std::string_view> methods = merge_methods();
  std::erase(methods, "alignment");
  return methods;
}

std::string name_of_test(std::string_view method) {
  std::string name(method);
  std::erase(name, '-');
  return name;
}

}  // namespace mapweld::test
