#include "tests/support/rendered_merge.h"

#include <algorithm>
#include <fstream>
#include <iterator>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>

#include "core/errors.h"
#include "core/feature/decode.h"
#include "core/feature/extractor.h"
#include "core/geometry/epipolar_verifier.h"
#include "core/mapping/mapper.h"
#include "core/merge/vote_source.h"
#include "core/vocabulary/appearance_vector.h"
#include "tests/support/rendering/parallel.h"
#include "tests/support/rendering/repeatable.h"
#include "tests/support/sample_maps.h"
#include "tests/support/shared_view.h"

namespace mapweld::rendered {
namespace {

class GrowingMap final : public MapView {
 public:
  void add(const MappingDecision& decision) {
    const auto id = static_cast<std::uint32_t>(made_.vertices.size());
    made_.vertex_of_image.push_back(id);
    index_.add(decision.image);
    made_.vertices.push_back(std::make_shared<const AppearanceVector>(decision.image));
    neighbours_.emplace_back();
    for (const LocalizationMatch& e : decision.edges) {
      neighbours_[id].push_back(to_index(e.vertex));
      neighbours_[to_index(e.vertex)].push_back(id);
      // The verdict is that of (image, vertex); edges run from the lower number to the higher.
      made_.inner_edges.push_back({e.vertex, VertexId{id}, mirrored(e.verification).inlier_matches});
    }
  }
  void ignore() { made_.vertex_of_image.push_back(MadeMap::kIgnored); }
  MadeMap take() {
    std::ranges::sort(made_.inner_edges, {}, [](const VerifiedEdge& e) { return std::pair(e.u, e.v); });
    return std::move(made_);
  }

  const PostingSource& postings() const override { return index_; }
  std::shared_ptr<const AppearanceVector> appearances(VertexId v) const override { return made_.vertices[to_index(v)]; }
  std::vector<VertexId> linked(VertexId v) const override {
    std::vector<VertexId> others;
    for (const std::uint32_t other : neighbours_[to_index(v)]) others.push_back(VertexId{other});
    return others;
  }
  std::optional<int> hops(VertexId u, VertexId v, int at_most) const override {
    std::vector<std::uint32_t> ring{to_index(u)};
    std::vector<bool> seen(made_.vertices.size(), false);
    for (int d = 0; d <= at_most; ++d) {
      std::vector<std::uint32_t> next;
      for (const std::uint32_t w : ring) {
        if (w == to_index(v)) return d;
        for (const std::uint32_t n : neighbours_[w]) {
          if (!seen[n]) next.push_back(n);
          seen[n] = true;
        }
      }
      ring = std::move(next);
    }
    return std::nullopt;
  }

 private:
  InvertedIndex index_;
  MadeMap made_;
  std::vector<std::vector<std::uint32_t>> neighbours_;
};

}  // namespace

std::vector<MergeMember> MadeMerge::members() const {
  return number_members({static_cast<std::uint32_t>(a.vertices.size()), static_cast<std::uint32_t>(b.vertices.size())});
}

std::vector<VerifiedEdge> MadeMerge::inner_edges() const {
  std::vector<VerifiedEdge> edges = a.inner_edges;
  const auto shift = static_cast<std::uint32_t>(a.vertices.size());
  for (const VerifiedEdge& e : b.inner_edges) {
    edges.push_back({VertexId{to_index(e.u) + shift}, VertexId{to_index(e.v) + shift}, e.inlier_matches});
  }
  return edges;
}

AppearanceTable MadeMerge::appearances() const {
  auto vectors = a.vertices;
  vectors.insert(vectors.end(), b.vertices.begin(), b.vertices.end());
  return AppearanceTable(std::move(vectors));
}

std::shared_ptr<const Vocabulary> shipped_vocabulary() {
  std::ifstream file(MAPWELD_SOURCE_DIR "/vocabularies/indoor-50k.mwv", std::ios::binary);
  const std::vector<std::uint8_t> bytes{std::istreambuf_iterator<char>(file), {}};
  return Vocabulary::deserialize(bytes);
}

MadeMap make_map(const std::vector<AppearanceVector>& images, const MapParameters& parameters) {
  const auto verifier = make_verifier();
  GrowingMap map;
  for (const AppearanceVector& image : images) {
    const MappingDecision decision = decide(image, map, *verifier, parameters);
    if (decision.outcome == MappingDecision::Outcome::kIgnored) {
      map.ignore();
    } else {
      map.add(decision);
    }
  }
  return map.take();
}

std::vector<AppearanceVector> see(const RenderedWorld& world, const std::vector<Pose>& poses,
                                  const CameraConditions& conditions, std::uint64_t noise_seed,
                                  const Vocabulary& vocabulary, int threads, std::optional<Overlay> overlay) {
  std::vector<AppearanceVector> images(poses.size());
  for_each_index(static_cast<int>(poses.size()), threads, [&](int i) {
    CameraConditions own = conditions;
    own.noise_seed = hash_of(noise_seed, i);
    const auto index = static_cast<std::size_t>(i);
    cv::Mat frame = world.render(poses[index], own).bgr;
    if (overlay) draw_overlay(frame, *overlay, static_cast<int>(noise_seed) + i);
    const Features features = extract_features(decode_grey(to_jpeg(frame)));
    images[index] = make_appearance_vector(features, vocabulary.quantise(features));
  });
  return images;
}

MadeMerge verify_all(MadeMap a, MadeMap b, int threads) {
  MadeMerge merge;
  merge.a = std::move(a);
  merge.b = std::move(b);
  const auto members = merge.members();
  const AppearanceTable appearances = merge.appearances();
  const WordVotes votes(appearances, members[0], members[1]);  // rows: b
  const MergeOptions options;
  const auto verifier = make_verifier();
  std::vector<MergeEdge> candidates;
  std::vector<std::uint32_t> row_votes;
  for (std::uint32_t row = 0; row < votes.rows(); ++row) {
    votes_of_row(votes, row, options.votes, row_votes);
    for (std::uint32_t column = 0; column < votes.columns(); ++column) {
      if (row_votes[column] < options.min_votes) continue;
      MergeEdge edge;
      edge.u = members[0].vertices[column];
      edge.v = members[1].vertices[row];
      edge.votes = row_votes[column];
      candidates.push_back(edge);
    }
  }
  merge.candidates = candidates.size();
  for_each_index(static_cast<int>(candidates.size()), threads, [&](int i) {
    MergeEdge& edge = candidates[static_cast<std::size_t>(i)];
    edge.verification = verifier->verify(*appearances.appearances(edge.u), *appearances.appearances(edge.v));
  });
  for (MergeEdge& edge : candidates) {
    if (edge.verification.accepted) merge.inter_edges.push_back(std::move(edge));
  }
  std::ranges::sort(merge.inter_edges, {}, [](const MergeEdge& e) { return std::pair(e.u, e.v); });
  return merge;
}

MadeMerge make_merge(const Drive& a, const Drive& b, const Vocabulary& vocabulary, int threads,
                     const MapParameters& parameters) {
  const auto map_of = [&](const Drive& drive) {
    MadeMap map =
        make_map(see(*drive.world, drive.poses, drive.conditions, drive.noise_seed, vocabulary, threads), parameters);
    for (std::size_t i = 0; i < drive.poses.size(); ++i) {
      if (map.vertex_of_image[i] != MadeMap::kIgnored) map.poses.push_back(drive.poses[i]);
    }
    return map;
  };
  MadeMerge merge = verify_all(map_of(a), map_of(b), threads);
  merge.shared.assign(merge.inter_edges.size(), 0);
  merge.best_shared.assign(merge.b.vertices.size(), 0);
  if (a.world != b.world) return merge;
  const auto views_a = view_records(*a.world, merge.a.poses, threads);
  const auto views_b = view_records(*b.world, merge.b.poses, threads);
  for (std::size_t i = 0; i < merge.inter_edges.size(); ++i) {
    merge.shared[i] =
        static_cast<float>(shared_view(views_a[to_index(merge.inter_edges[i].u)],
                                       views_b[to_index(merge.inter_edges[i].v) - merge.a.vertices.size()]));
  }
  for (const SharedPair& pair : shared_pairs(views_a, views_b, 0.05, threads)) {
    float& best = merge.best_shared[static_cast<std::size_t>(pair.b)];
    best = std::max(best, static_cast<float>(pair.shared));
  }
  return merge;
}

// ---- The cache ----------------------------------------------------------------------------------------------------

namespace {

constexpr std::uint64_t kMagic = 0x4d57475541524434;

template <typename T>
void put(std::ostream& out, const T& value) {
  static_assert(std::is_trivially_copyable_v<T>);
  out.write(reinterpret_cast<const char*>(&value), sizeof value);
}
template <typename T>
T get(std::istream& in) {
  T value{};
  if (!in.read(reinterpret_cast<char*>(&value), sizeof value)) throw FormatError("a merge's cache ends early");
  return value;
}
template <typename T>
void put_all(std::ostream& out, const std::vector<T>& values) {
  put(out, static_cast<std::uint64_t>(values.size()));
  for (const T& value : values) put(out, value);
}
template <typename T>
std::vector<T> get_all(std::istream& in) {
  const auto size = get<std::uint64_t>(in);
  if (size > 100'000'000) throw FormatError("a merge's cache is damaged");
  std::vector<T> values;
  values.reserve(size);
  for (std::uint64_t i = 0; i < size; ++i) values.push_back(get<T>(in));
  return values;
}

using Matches = std::vector<std::pair<std::uint16_t, std::uint16_t>>;

void put_matches(std::ostream& out, const Matches& matches) {
  put(out, static_cast<std::uint64_t>(matches.size()));
  for (const auto& [i, j] : matches) {
    put(out, i);
    put(out, j);
  }
}
Matches get_matches(std::istream& in) {
  Matches matches;
  const auto size = get<std::uint64_t>(in);
  for (std::uint64_t m = 0; m < size; ++m) {
    const auto first = get<std::uint16_t>(in);
    matches.emplace_back(first, get<std::uint16_t>(in));
  }
  return matches;
}

void put_map(std::ostream& out, const MadeMap& map) {
  put(out, static_cast<std::uint64_t>(map.vertices.size()));
  for (const auto& vector : map.vertices) {
    put(out, vector->width_px);
    put(out, vector->height_px);
    put_all(out, vector->appearances);
    put_all(out, vector->static_appearances);
  }
  put(out, static_cast<std::uint64_t>(map.inner_edges.size()));
  for (const VerifiedEdge& edge : map.inner_edges) {
    put(out, edge.u);
    put(out, edge.v);
    put_matches(out, edge.inlier_matches);
  }
  put_all(out, map.poses);
  put_all(out, map.vertex_of_image);
}

MadeMap get_map(std::istream& in) {
  MadeMap map;
  const auto size = get<std::uint64_t>(in);
  for (std::uint64_t i = 0; i < size; ++i) {
    AppearanceVector vector;
    vector.width_px = get<int>(in);
    vector.height_px = get<int>(in);
    vector.appearances = get_all<Appearance>(in);
    vector.static_appearances = get_all<Appearance>(in);
    map.vertices.push_back(std::make_shared<const AppearanceVector>(std::move(vector)));
  }
  const auto edges = get<std::uint64_t>(in);
  for (std::uint64_t i = 0; i < edges; ++i) {
    VerifiedEdge& edge = map.inner_edges.emplace_back();
    edge.u = get<VertexId>(in);
    edge.v = get<VertexId>(in);
    edge.inlier_matches = get_matches(in);
  }
  map.poses = get_all<Pose>(in);
  map.vertex_of_image = get_all<std::uint32_t>(in);
  return map;
}

}  // namespace

void write_merge(const MadeMerge& merge, const std::filesystem::path& file) {
  const std::filesystem::path part = file.string() + ".part";
  {
    std::ofstream out(part, std::ios::binary);
    put(out, kMagic);
    put_map(out, merge.a);
    put_map(out, merge.b);
    put(out, merge.candidates);
    put(out, static_cast<std::uint64_t>(merge.inter_edges.size()));
    for (const MergeEdge& edge : merge.inter_edges) {
      put(out, edge.u);
      put(out, edge.v);
      put(out, edge.votes);
      put(out, edge.verification.matches);
      put(out, edge.verification.inliers);
      put(out, edge.verification.log10_false_alarms);
      put(out, edge.verification.kind);
      put(out, edge.verification.geometry);
      put_matches(out, edge.verification.inlier_matches);
    }
    put_all(out, merge.shared);
    put_all(out, merge.best_shared);
    if (!out.flush()) throw std::runtime_error("cannot write " + part.string());
  }
  std::filesystem::rename(part, file);
}

MadeMerge read_merge(const std::filesystem::path& file) {
  std::ifstream in(file, std::ios::binary);
  if (get<std::uint64_t>(in) != kMagic) throw FormatError("not a merge's cache");
  MadeMerge merge;
  merge.a = get_map(in);
  merge.b = get_map(in);
  merge.candidates = get<std::uint64_t>(in);
  const auto edges = get<std::uint64_t>(in);
  for (std::uint64_t i = 0; i < edges; ++i) {
    MergeEdge edge;
    edge.u = get<VertexId>(in);
    edge.v = get<VertexId>(in);
    edge.votes = get<std::uint32_t>(in);
    edge.verification.accepted = true;
    edge.verification.matches = get<int>(in);
    edge.verification.inliers = get<int>(in);
    edge.verification.log10_false_alarms = get<double>(in);
    edge.verification.kind = get<GeometryKind>(in);
    edge.verification.geometry = get<std::array<double, 9>>(in);
    edge.verification.inlier_matches = get_matches(in);
    merge.inter_edges.push_back(std::move(edge));
  }
  merge.shared = get_all<float>(in);
  merge.best_shared = get_all<float>(in);
  return merge;
}

}  // namespace mapweld::rendered
