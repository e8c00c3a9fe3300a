// A merge's state survives its checkpoint bit for bit, whole or in pieces; what is damaged is refused.
#include "schema/blobs/merge_state_blob.h"

#include <algorithm>
#include <map>
#include <random>

#include <gtest/gtest.h>

#include "core/merge/make_merger.h"
#include "core/merge/methods/quick_connect.h"
#include "core/merge/run.h"
#include "tests/core/merge/toy_maps.h"

namespace mapweld {
namespace {

using blobs::MergeStatePart;

StopCondition stop_at_step(std::uint64_t step) {
  return stop_when_merger([step](const Merger& m) { return m.state().step >= step; }, StopReason::kPaused);
}

// What a store keeps: the newest part of each name, and the edges.
class PartStore {
 public:
  void save(const MergeState& state) {
    for (MergeStatePart& part : blobs::encode_merge_state(state, mark_)) {
      std::string name = part.name;
      parts_[name] = std::move(part);
    }
    edges_ = state.edges;
    mark_ = blobs::mark_of(state);
  }
  MergeState load() const { return blobs::decode_merge_state(parts(), edges_); }
  std::vector<MergeStatePart> parts() const {
    std::vector<MergeStatePart> all;
    for (const auto& [name, part] : parts_) all.push_back(part);
    return all;
  }
  const std::vector<MergeEdge>& edges() const { return edges_; }
  std::size_t bytes() const {
    std::size_t sum = 0;
    for (const auto& [name, part] : parts_) sum += part.bytes.size();
    return sum;
  }

 private:
  std::map<std::string, MergeStatePart> parts_;
  std::vector<MergeEdge> edges_;
  std::optional<blobs::MergeStateMark> mark_;
};

// Dense or sparse S, whole words or parts of them.
std::unique_ptr<Merger> merger_of(MergeInput input, const std::string& variant) {
  if (variant != "sparse") return make_merger(std::move(input));
  const MemberPair pair = order_members(input.members);
  input.votes = std::make_shared<WordVotes>(*input.appearances, input.members[pair.m1], input.members[pair.m2]);
  return std::make_unique<QuickConnect>(std::move(input), QuickConnect::Limits{0, 5});
}

test::ToyWorld world_of(std::uint32_t seed, const std::string& variant) {
  test::ToyWorld world = test::toy_world(seed);
  if (std::ranges::find(merge_methods(), variant) != merge_methods().end()) world.method = variant;
  if (variant == "several") world.sizes = {7, 9, 6};
  return world;
}

std::vector<std::string> variants() {
  std::vector<std::string> all{"dense", "sparse", "several"};
  for (const std::string_view method : merge_methods()) all.emplace_back(method);
  return all;
}

TEST(MergeStateBlob, KeepsTheStateAtEveryStep) {
  for (const std::string& variant : variants()) {
    for (std::uint32_t seed = 0; seed < 14; ++seed) {
      const auto merger = merger_of(make_toy_merge(world_of(seed, variant)), variant);
      PartStore always;
      always.save(merger->state());
      ASSERT_EQ(always.load(), merger->state());
      run(*merger, {}, [&](const Merger& m) {
        always.save(m.state());  // only what can have changed
        ASSERT_EQ(always.load(), m.state()) << variant << " seed " << seed << " step " << m.state().step;
      });
    }
  }
}

TEST(MergeStateBlob, KeepsTheStateWhenSavedNowAndThen) {
  std::mt19937 random(3);
  for (const std::string& variant : variants()) {
    for (std::uint32_t seed = 0; seed < 40; ++seed) {
      const auto merger = merger_of(make_toy_merge(world_of(seed, variant)), variant);
      PartStore store;
      while (!merger->done()) {
        run(*merger, stop_at_step(merger->state().step + 1 + random() % 60));
        store.save(merger->state());
        ASSERT_EQ(store.load(), merger->state()) << variant << " seed " << seed;
      }
    }
  }
}

// run(n) equals run(k), save, load, run(n - k).
TEST(MergeStateBlob, IsEnoughToGoOnFrom) {
  std::mt19937 random(1);
  for (const std::string_view method : merge_methods()) {
    for (std::uint32_t seed = 0; seed < 40; ++seed) {
      test::ToyWorld world = test::toy_world(seed);
      world.method = method;
      const MergeInput input = make_toy_merge(world);
      const auto whole = make_merger(input);
      run(*whole, {});
      for (int k = 0; k < 4; ++k) {
        const auto first = make_merger(input);
        run(*first, stop_at_step(random() % (whole->state().step + 1)));
        PartStore store;
        store.save(first->state());
        const auto second = make_merger(input, store.load());
        run(*second, {});
        ASSERT_EQ(second->state(), whole->state()) << method << " seed " << seed;
      }
    }
  }
}

TEST(MergeStateBlob, LeavesOutWhatCannotHaveChanged) {
  const auto merger = make_merger(make_toy_merge(test::toy_world(19)));
  run(*merger, stop_when_merger([](const Merger& m) { return m.state().phase == MergePhase::kRefinement; },
                                StopReason::kPaused));
  const blobs::MergeStateMark mark = blobs::mark_of(merger->state());
  merger->step();
  std::vector<std::string> names;
  for (const MergeStatePart& part : blobs::encode_merge_state(merger->state(), mark)) names.push_back(part.name);
  for (const char* frozen : {"similarity", "queue", "postponed"}) {
    EXPECT_EQ(std::ranges::count(names, frozen), 0) << frozen;
  }
  EXPECT_EQ(std::ranges::count(names, "state"), 1);
}

TEST(MergeStateBlob, PagesTheRejectedPairs) {
  MergeState state;
  state.method = "brute-force";
  state.phase = MergePhase::kVerification;
  PartStore store;
  for (std::uint32_t i = 0; i < 3 * blobs::kRejectedPerPage + 5; ++i) {
    state.rejected.push_back({VertexId{i % 977}, VertexId{i}, Reason::kTooFewInliers, 31, 4});
    if (i % 5000 == 17) store.save(state);
  }
  const std::size_t pages_since = blobs::encode_merge_state(state, blobs::mark_of(state)).size();
  EXPECT_EQ(pages_since, 1u);  // "state" alone
  store.save(state);
  EXPECT_EQ(store.load(), state);
  EXPECT_EQ(store.parts().size(), 4u + 4u);

  // Each page can be read alone; together they are the whole list.
  std::vector<RejectedPair> together;
  for (std::size_t page = 0; page < 4; ++page) {
    const auto parts = store.parts();
    const auto part = std::ranges::find(parts, blobs::rejected_page_name(page), &MergeStatePart::name);
    ASSERT_NE(part, parts.end()) << page;
    const std::vector<RejectedPair> pairs = blobs::decode_rejected_page(*part);
    EXPECT_EQ(pairs.size(), page < 3 ? blobs::kRejectedPerPage : 5u);
    together.insert(together.end(), pairs.begin(), pairs.end());
    MergeStatePart torn = *part;
    torn.bytes.pop_back();
    EXPECT_THROW(blobs::decode_rejected_page(torn), StoreError);
  }
  EXPECT_EQ(together, state.rejected);
}

TEST(MergeStateBlob, RefusesDamage) {
  const auto merger = make_merger(make_toy_merge(test::toy_world(19)));
  run(*merger, stop_at_edges(20));
  PartStore store;
  store.save(merger->state());
  const std::vector<MergeStatePart> good = store.parts();
  const auto expect_kind = [&](const std::vector<MergeStatePart>& parts, const std::vector<MergeEdge>& edges,
                               StoreErrorKind kind, const std::string& what) {
    try {
      blobs::decode_merge_state(parts, edges);
      ADD_FAILURE() << what << " was accepted";
    } catch (const StoreError& error) {
      EXPECT_EQ(error.kind(), kind) << what;
    }
  };
  EXPECT_NO_THROW(blobs::decode_merge_state(good, store.edges()));
  for (std::size_t p = 0; p < good.size(); ++p) {
    const std::string& name = good[p].name;
    for (std::size_t at = 0; at < good[p].bytes.size(); at += 1 + good[p].bytes.size() / 40) {
      if (at == 1) continue;  // the version, below
      std::vector<MergeStatePart> parts = good;
      parts[p].bytes[at] ^= 0x10;
      expect_kind(parts, store.edges(), StoreErrorKind::kCorrupt,
                  name + " with a flipped bit at " + std::to_string(at));
      parts = good;
      parts[p].bytes.resize(at);
      expect_kind(parts, store.edges(), StoreErrorKind::kCorrupt, name + " cut at " + std::to_string(at));
    }
    std::vector<MergeStatePart> parts = good;
    parts.erase(parts.begin() + static_cast<std::ptrdiff_t>(p));
    expect_kind(parts, store.edges(), StoreErrorKind::kCorrupt, "without " + name);
  }
  std::vector<MergeEdge> fewer = store.edges();
  fewer.pop_back();
  expect_kind(good, fewer, StoreErrorKind::kCorrupt, "an edge less");
}

TEST(MergeStateBlob, RefusesANewerVersion) {
  blobs::ByteWriter newer('M', 2);
  newer.varint(0);
  const std::vector<MergeStatePart> parts{{"state", std::move(newer).finish()}};
  try {
    blobs::decode_merge_state(parts, {});
    ADD_FAILURE() << "accepted";
  } catch (const StoreError& error) {
    EXPECT_EQ(error.kind(), StoreErrorKind::kNewerVersion);
  }
}

}  // namespace
}  // namespace mapweld
