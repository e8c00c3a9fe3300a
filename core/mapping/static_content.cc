#include "core/mapping/static_content.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <iterator>
#include <set>
#include <utility>
#include <vector>

namespace mapweld {
namespace {

// The vertices to look at. Their distance is a power of two, so that it seldom changes.
std::vector<VertexId> sampled(std::uint32_t vertices, std::uint32_t sample) {
  std::uint32_t step = 1;
  while (vertices / step >= 2 * sample) step *= 2;
  std::vector<VertexId> chosen;
  for (std::uint32_t v = 0; v < vertices; v += step) chosen.push_back(VertexId{v});
  return chosen;
}

// In how many images each appearance of one was found.
class Sightings {
 public:
  explicit Sightings(const AppearanceVector& image) : images_(image.appearances.size(), 0) {}
  void add(const std::vector<std::uint8_t>& found) {
    for (std::size_t i = 0; i < found.size(); ++i) images_[i] += found[i];
  }
  // Sets those apart that were found in so many. Returns whether there were any.
  bool set_apart(AppearanceVector& image, int fewest_images) const {
    const auto is_static = [&](int images) { return images >= fewest_images; };
    if (std::ranges::none_of(images_, is_static)) return false;
    std::vector<Appearance> kept;
    for (std::size_t i = 0; i < images_.size(); ++i) {
      (is_static(images_[i]) ? image.static_appearances : kept).push_back(image.appearances[i]);
    }
    image.appearances = std::move(kept);
    std::ranges::sort(image.static_appearances);
    return true;
  }

 private:
  std::vector<int> images_;
};

// Vertices that teach nothing any more: some, and all that are linked with them.
class Neighbourhood {
 public:
  Neighbourhood(std::span<const VertexId> linked, const MapView& map)
      : taken_(linked.begin(), linked.end()), map_(map) {}
  // Whether `vertex` is among them, or linked with one that is.
  bool touches(VertexId vertex) const {
    return taken_.contains(vertex) ||
           std::ranges::any_of(map_.linked(vertex), [&](VertexId other) { return taken_.contains(other); });
  }
  void take(VertexId vertex) {
    taken_.insert(vertex);
    std::ranges::copy(map_.linked(vertex), std::inserter(taken_, taken_.end()));
  }

 private:
  std::set<VertexId> taken_;
  const MapView& map_;
};

}  // namespace

AppearanceVector with_known_static(AppearanceVector image, const MapView& map, const StaticContentOptions& options) {
  Sightings sightings(image);
  for (const VertexId vertex : sampled(map.postings().vertices(), options.sample)) {
    const auto other = map.appearances(vertex);
    if (other->static_appearances.empty()) continue;
    const AppearanceVector only_static{other->width_px, other->height_px, other->static_appearances};
    sightings.add(at_same_place(image, only_static, options.match));
  }
  sightings.set_apart(image, options.fewest_images);
  return image;
}

bool learn_static(AppearanceVector& image, std::span<const VertexId> linked, const MapView& map,
                  const StaticContentOptions& options) {
  Sightings sightings(image);
  Neighbourhood neighbourhood(linked, map);
  for (const VertexId vertex : sampled(map.postings().vertices(), options.sample)) {
    const auto other = map.appearances(vertex);
    const std::vector<std::uint8_t> found = at_same_place(image, *other, options.match);
    const auto common = static_cast<double>(std::ranges::count(found, 1));
    const std::size_t fewer = std::min(found.size(), other->appearances.size() + other->static_appearances.size());
    const bool is_same_view = common > options.same_view * static_cast<double>(fewer);
    if (common == 0 || is_same_view || neighbourhood.touches(vertex)) continue;
    neighbourhood.take(vertex);
    sightings.add(found);
  }
  return sightings.set_apart(image, options.fewest_images);
}

double static_share(std::span<const AppearanceVector> images) {
  constexpr int kAcross = 16;
  constexpr int kDown = 12;
  constexpr int kFewestImages = 2;
  const auto cell_of = [](float at_px, int length_px, int cells) {
    const auto length = static_cast<float>(std::max(length_px, 1));
    return std::clamp(static_cast<int>(at_px * static_cast<float>(cells) / length), 0, cells - 1);
  };
  std::array<int, kAcross * kDown> images_with{};
  for (const AppearanceVector& image : images) {
    std::set<int> cells;
    for (const Appearance& p : image.static_appearances) {
      cells.insert(cell_of(p.y_px, image.height_px, kDown) * kAcross + cell_of(p.x_px, image.width_px, kAcross));
    }
    for (const int cell : cells) ++images_with[static_cast<std::size_t>(cell)];
  }
  const auto taken = std::ranges::count_if(images_with, [](int n) { return n >= kFewestImages; });
  return static_cast<double>(taken) / static_cast<double>(images_with.size());
}

}  // namespace mapweld
