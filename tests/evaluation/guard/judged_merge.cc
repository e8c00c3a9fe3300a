#include "tests/evaluation/guard/judged_merge.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <memory>
#include <stdexcept>

#include "core/geometry/epipolar_verifier.h"
#include "tests/core/geometry/photographs.h"
#include "tests/evaluation/guard/photograph_truth.h"
#include "tests/support/merge_scenarios.h"
#include "tests/support/rendering/parallel.h"

namespace mapweld::evaluation {
namespace {

namespace fs = std::filesystem;
using rendered::MadeMap;
using rendered::MadeMerge;

constexpr float kSharedView = 0.1f, kNothingShared = 0.02f;
constexpr double kFarInside_m = 10;

fs::path file_of(const GuardCase& c, const fs::path& cache, const char* ending) { return cache / (c.name + ending); }

template <typename T>
std::vector<T> in_order_of_upload(const std::vector<T>& all, const UploadOrder& order, std::uint64_t map) {
  std::vector<T> sequence;
  sequence.reserve(all.size());
  for (const std::size_t i : uploaded(order, all.size(), map)) sequence.push_back(all[i]);
  return sequence;
}

std::vector<PhotographName> photographs_of(const std::vector<std::string>& folders) {
  std::vector<PhotographName> all;
  for (const std::string& folder : folders) {
    const auto names = photograph_names(folder);
    if (names.empty()) throw std::runtime_error("no photographs in " + (photographs_folder() / folder).string());
    for (const std::string& name : names) all.push_back({folder, name});
  }
  return all;
}

struct MapAndIgnored {
  MadeMap map;
  std::vector<std::uint32_t> resembles;  // the vertex of each ignored image
};

MapAndIgnored map_of(const std::vector<std::string>& folders, const UploadOrder& order, std::uint64_t number,
                     int threads) {
  std::vector<AppearanceVector> images;
  for (const std::string& folder : folders) {
    for (const auto& photograph : test::photographs(folder)) images.push_back(photograph.appearances);
  }
  images = in_order_of_upload(images, order, number);
  MapAndIgnored made{rendered::make_map(images), {}};
  const auto verifier = make_verifier();
  for (std::size_t i = 0; i < images.size(); ++i) {
    if (made.map.vertex_of_image[i] != MadeMap::kIgnored) continue;
    const auto& vertices = made.map.vertices;
    std::vector<int> inliers(vertices.size());
    rendered::for_each_index(static_cast<int>(vertices.size()), threads, [&](int v) {
      inliers[static_cast<std::size_t>(v)] =
          verifier->verify(images[i], *vertices[static_cast<std::size_t>(v)]).inliers;
    });
    made.resembles.push_back(static_cast<std::uint32_t>(std::ranges::max_element(inliers) - inliers.begin()));
  }
  return made;
}

MadeMerge make(const GuardCase& c, const fs::path& cache, int threads) {
  if (c.is_rendered()) {
    static const auto vocabulary = rendered::shipped_vocabulary();
    return rendered::make_scenario(c.scenario, c.seed, *vocabulary, threads);
  }
  MapAndIgnored a = map_of(c.a, c.order, 0, threads), b = map_of(c.b, c.order, 1, threads);
  std::ofstream ignored(file_of(c, cache, ".ignored"));
  for (const std::uint32_t v : a.resembles) ignored << v << "\n";
  for (const std::uint32_t v : b.resembles) ignored << v + a.map.vertices.size() << "\n";
  if (!ignored.flush()) throw std::runtime_error("cannot write below " + cache.string());
  return rendered::verify_all(std::move(a.map), std::move(b.map), threads);
}

void judge_photographs(const GuardCase& c, const fs::path& cache, JudgedMerge& judged) {
  const auto& merge = judged.merge;
  std::vector<PhotographName> at(merge.a.vertices.size() + merge.b.vertices.size());
  const auto place = [&](const std::vector<std::string>& folders, const MadeMap& map, std::uint64_t number,
                         std::size_t shift) {
    const auto photographs = in_order_of_upload(photographs_of(folders), c.order, number);
    if (photographs.size() != map.vertex_of_image.size()) {
      throw std::runtime_error(c.name + ": the cache is of other photographs");
    }
    for (std::size_t i = 0; i < photographs.size(); ++i) {
      if (map.vertex_of_image[i] != MadeMap::kIgnored) at[shift + map.vertex_of_image[i]] = photographs[i];
    }
  };
  place(c.a, merge.a, 0, 0);
  place(c.b, merge.b, 1, merge.a.vertices.size());
  PhotographTruth truth;
  const auto of = [&](const auto& edge) { return truth.of(at[to_index(edge.u)], at[to_index(edge.v)]); };
  for (const MergeEdge& edge : merge.inter_edges) judged.inter_truth.push_back(of(edge));
  for (const VerifiedEdge& edge : judged.inner) judged.inner_truth.push_back(of(edge));
  for (const PhotographName& photograph : at) judged.shown.push_back(photograph.folder + "/" + photograph.name);
  std::ifstream ignored(file_of(c, cache, ".ignored"));
  for (std::size_t v = 0; ignored >> v;) ++judged.images.at(v);
}

void judge_rendered(JudgedMerge& judged) {
  const auto& merge = judged.merge;
  std::vector<rendered::Pose> poses = merge.a.poses;
  poses.insert(poses.end(), merge.b.poses.begin(), merge.b.poses.end());
  for (const float shared : merge.shared) {
    judged.inter_truth.push_back(shared >= kSharedView     ? Truth::kRight
                                 : shared < kNothingShared ? Truth::kWrong
                                                           : Truth::kUnknown);
  }
  for (const VerifiedEdge& edge : judged.inner) {
    const rendered::Pose& u = poses[to_index(edge.u)];
    const rendered::Pose& v = poses[to_index(edge.v)];
    const bool far = u.storey != v.storey || std::hypot(u.x_m - v.x_m, u.y_m - v.y_m) > kFarInside_m;
    judged.inner_truth.push_back(far ? Truth::kWrong : Truth::kUnknown);
  }
  for (const rendered::Pose& pose : poses) {
    char text[64];
    std::snprintf(text, sizeof text, "(%.1f m, %.1f m, %.0f deg, storey %d)", pose.x_m, pose.y_m, pose.heading_deg,
                  pose.storey);
    judged.shown.emplace_back(text);
  }
}

}  // namespace

bool is_cached(const GuardCase& c, const fs::path& cache) { return fs::exists(file_of(c, cache, ".merge")); }

JudgedMerge judged_merge(const GuardCase& c, const fs::path& cache, int threads) {
  const fs::path file = file_of(c, cache, ".merge");
  JudgedMerge judged;
  if (fs::exists(file)) {
    judged.merge = rendered::read_merge(file);
  } else {
    judged.merge = make(c, cache, threads);
    rendered::write_merge(judged.merge, file);
  }
  judged.inner = judged.merge.inner_edges();
  judged.images.assign(judged.merge.a.vertices.size() + judged.merge.b.vertices.size(), 1);
  if (c.is_rendered()) {
    judge_rendered(judged);
  } else {
    judge_photographs(c, cache, judged);
  }
  return judged;
}

}  // namespace mapweld::evaluation
