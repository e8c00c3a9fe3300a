#include "core/vocabulary/hnsw_graph.h"

#include <algorithm>
#include <array>
#include <iterator>
#include <limits>
#include <numeric>
#include <utility>

// hnswlib's own SIMD defines functions in the header and speaks of floats only.
#define NO_MANUAL_VECTORIZATION
#include <hnswlib/hnswlib.h>

#include "core/errors.h"
#include "core/random.h"
#include "core/vocabulary/byte_stream.h"
#include "core/vocabulary/distance.h"

namespace mapweld {
namespace {

constexpr std::uint32_t kFormat = 1;
constexpr std::uint32_t kMaxLevels = 64;

class ByteSpace final : public hnswlib::SpaceInterface<int> {
 public:
  std::size_t get_data_size() override { return kDescriptorDimension; }
  hnswlib::DISTFUNC<int> get_dist_func() override { return distance; }
  void* get_dist_func_param() override { return &pair_; }

 private:
  using Pair = decltype(DistanceKernel::pair);
  static int distance(const void* a, const void* b, const void* pair) {
    return static_cast<int>(
        (*static_cast<const Pair*>(pair))(static_cast<const std::uint8_t*>(a), static_cast<const std::uint8_t*>(b)));
  }
  Pair pair_ = distance_kernel().pair;
};

// hnswlib numbers nodes as they were inserted: `inserted[i]` is our number of its node i, `place` the inverse.
HnswGraph::Level read_level(const hnswlib::HierarchicalNSW<int>& built, const std::vector<std::uint32_t>& inserted,
                            const std::vector<std::uint32_t>& place, int level) {
  HnswGraph::Level out;
  for (std::uint32_t node = 0; node < place.size(); ++node) {
    if (built.element_levels_[place[node]] < level) continue;
    auto* list = built.get_linklist_at_level(place[node], level);
    const auto count = built.getListCount(list);
    const auto* first = reinterpret_cast<const std::uint32_t*>(list + 1);
    out.nodes.push_back(node);
    std::transform(first, first + count, std::back_inserter(out.links), [&](std::uint32_t i) { return inserted[i]; });
    std::sort(out.links.end() - count, out.links.end());
    out.offsets.push_back(static_cast<std::uint32_t>(out.links.size()));
  }
  return out;
}

// Fisher & Yates.
std::vector<std::uint32_t> shuffled(std::uint32_t size, std::uint32_t seed) {
  std::vector<std::uint32_t> order(size);
  std::iota(order.begin(), order.end(), 0u);
  SplitMix64 random(seed);
  for (std::uint32_t i = size; i > 1; --i) std::swap(order[i - 1], order[random.below(i)]);
  return order;
}

// Differences of an ascending list are small numbers; their bytes, plane by plane, compress well.
void write_planes(ByteWriter& writer, const std::vector<std::uint32_t>& values) {
  std::vector<std::uint8_t> planes(values.size() * 4);
  for (std::size_t i = 0; i < values.size(); ++i) {
    for (std::size_t plane = 0; plane < 4; ++plane) {
      planes[plane * values.size() + i] = static_cast<std::uint8_t>(values[i] >> (8 * plane));
    }
  }
  writer.array(std::span<const std::uint8_t>(planes));
}

std::vector<std::uint32_t> read_planes(ByteReader& reader) {
  const auto planes = reader.array<std::uint8_t>();
  if (planes.size() % 4 != 0) throw FormatError("HNSW graph: broken planes");
  std::vector<std::uint32_t> values(planes.size() / 4);
  for (std::size_t i = 0; i < values.size(); ++i) {
    for (std::size_t plane = 0; plane < 4; ++plane) {
      values[i] |= std::uint32_t{planes[plane * values.size() + i]} << (8 * plane);
    }
  }
  return values;
}

// A list's first link is told as its distance from the node, with the sign in the lowest bit.
std::uint32_t fold(std::uint32_t link, std::uint32_t node) {
  return link >= node ? (link - node) << 1 : ((node - link) << 1) - 1;
}
std::uint32_t unfold(std::uint32_t value, std::uint32_t node) {
  return (value & 1) == 0 ? node + (value >> 1) : node - ((value + 1) >> 1);
}

HnswGraph::Level decode_level(ByteReader& reader, std::uint32_t size) {
  HnswGraph::Level level;
  level.nodes = read_planes(reader);
  const auto counts = reader.array<std::uint8_t>();
  level.links = read_planes(reader);
  if (counts.size() != level.nodes.size()) throw FormatError("HNSW graph: counts and nodes differ");

  std::uint64_t node = 0;
  std::size_t at = 0;
  for (std::size_t i = 0; i < counts.size(); ++i) {
    node = i == 0 ? level.nodes[i] : node + level.nodes[i];
    if (node >= size || (i > 0 && level.nodes[i] == 0)) throw FormatError("HNSW graph: nodes out of order");
    level.nodes[i] = static_cast<std::uint32_t>(node);
    if (counts[i] > level.links.size() - at) throw FormatError("HNSW graph: links are missing");
    for (std::size_t k = 0; k < counts[i]; ++k) {
      std::uint32_t& link = level.links[at + k];
      link = k == 0 ? unfold(link, level.nodes[i]) : level.links[at + k - 1] + link;
      if (link >= size) throw FormatError("HNSW graph: a link leads nowhere");
    }
    at += counts[i];
    level.offsets.push_back(static_cast<std::uint32_t>(at));
  }
  if (at != level.links.size()) throw FormatError("HNSW graph: links without a node");
  return level;
}

}  // namespace

HnswGraph build_hnsw_graph(std::span<const std::uint8_t> points, const HnswBuildOptions& options) {
  if (options.links < 2 || options.links > 127 || options.build_effort < 1) {
    throw FormatError("HNSW: links must be 2 to 127 and the build effort at least 1");
  }
  HnswGraph graph;
  graph.size = static_cast<std::uint32_t>(points.size() / kDescriptorDimension);
  if (graph.size == 0) return graph;

  ByteSpace space;
  hnswlib::HierarchicalNSW<int> built(&space, graph.size, static_cast<std::size_t>(options.links),
                                      static_cast<std::size_t>(options.build_effort), options.seed);
  const std::vector<std::uint32_t> inserted = shuffled(graph.size, options.seed);
  std::vector<std::uint32_t> place(graph.size);
  for (std::uint32_t i = 0; i < graph.size; ++i) {
    built.addPoint(points.data() + std::size_t{inserted[i]} * kDescriptorDimension, i);
    place[inserted[i]] = i;
  }
  graph.entry = inserted[built.enterpoint_node_];
  for (int level = 0; level <= built.maxlevel_; ++level) {
    graph.levels.push_back(read_level(built, inserted, place, level));
  }
  return graph;
}

std::vector<std::uint8_t> encode_hnsw_graph(const HnswGraph& graph) {
  ByteWriter writer;
  writer.number(kFormat);
  writer.number(graph.size);
  writer.number(graph.entry);
  writer.number(static_cast<std::uint32_t>(graph.levels.size()));
  for (const HnswGraph::Level& level : graph.levels) {
    std::vector<std::uint32_t> nodes = level.nodes;
    std::vector<std::uint8_t> counts(nodes.size());
    std::vector<std::uint32_t> links = level.links;
    for (std::size_t i = nodes.size(); i-- > 0;) {
      const std::uint32_t first = level.offsets[i];
      counts[i] = static_cast<std::uint8_t>(level.offsets[i + 1] - first);
      for (std::uint32_t k = level.offsets[i + 1]; k-- > first;) {
        links[k] = k == first ? fold(links[k], level.nodes[i]) : links[k] - links[k - 1];
      }
      if (i > 0) nodes[i] -= nodes[i - 1];
    }
    write_planes(writer, nodes);
    writer.array(std::span<const std::uint8_t>(counts));
    write_planes(writer, links);
  }
  return writer.take();
}

HnswGraph decode_hnsw_graph(std::span<const std::uint8_t> bytes, std::uint32_t size) {
  ByteReader reader(bytes);
  if (reader.number<std::uint32_t>() != kFormat) throw FormatError("HNSW graph: unknown format");
  HnswGraph graph;
  graph.size = reader.number<std::uint32_t>();
  graph.entry = reader.number<std::uint32_t>();
  const auto levels = reader.number<std::uint32_t>();
  if (graph.size != size || levels > kMaxLevels || (levels == 0) != (size == 0)) {
    throw FormatError("HNSW graph: made for another number of words");
  }
  for (std::uint32_t i = 0; i < levels; ++i) graph.levels.push_back(decode_level(reader, size));
  reader.expect_end();
  if (size > 0 && (graph.levels[0].nodes.size() != size || graph.entry >= size)) {
    throw FormatError("HNSW graph: nodes are missing");
  }
  return graph;
}

}  // namespace mapweld
