#include "tests/evaluation/guard/upload_order.h"

#include <algorithm>
#include <stdexcept>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace mapweld::evaluation {
namespace {

TEST(UploadOrder, EveryPhotographIsUploadedOnce) {
  EXPECT_THAT(uploaded(upload_order_of("given"), 4, 0), testing::ElementsAre(0, 1, 2, 3));
  EXPECT_THAT(uploaded(upload_order_of("reversed"), 4, 0), testing::ElementsAre(3, 2, 1, 0));
  const auto shuffled = uploaded(upload_order_of("shuffled:5"), 100, 0);
  EXPECT_THAT(shuffled, testing::UnorderedElementsAreArray(uploaded({}, 100, 0)));
  // Of 100 at random one stays in its place in the mean.
  std::size_t stay = 0;
  for (std::size_t i = 0; i < shuffled.size(); ++i) stay += shuffled[i] == i ? 1 : 0;
  EXPECT_LE(stay, 6u);
}

TEST(UploadOrder, AnOrderBelongsToItsSeedAndItsMap) {
  const auto order = [](const char* text, std::uint64_t map) { return uploaded(upload_order_of(text), 30, map); };
  EXPECT_EQ(order("shuffled:5", 0), order("shuffled:5", 0));
  EXPECT_NE(order("shuffled:5", 0), order("shuffled:6", 0));
  EXPECT_NE(order("shuffled:5", 0), order("shuffled:5", 1));
  EXPECT_EQ(upload_order_suffix(upload_order_of("given")), "");
  EXPECT_NE(upload_order_suffix(upload_order_of("shuffled:5")), upload_order_suffix(upload_order_of("shuffled:6")));
}

TEST(UploadOrder, WhatIsNoOrderIsRefused) {
  for (const char* text : {"", "Given", "shuffled", "shuffled:", "shuffled:x", "shuffled:1x", "shuffled:-1"}) {
    EXPECT_THROW(upload_order_of(text), std::invalid_argument) << text;
  }
}

}  // namespace
}  // namespace mapweld::evaluation
