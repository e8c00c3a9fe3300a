#include "server/http/wire/entity_tag.h"

#include <gtest/gtest.h>

namespace mapweld::server {
namespace {

TEST(EntityTag, IsFoundInALine) {
  EXPECT_TRUE(names_entity_tag(R"("a")", R"("a")"));
  EXPECT_TRUE(names_entity_tag(R"("x", "a")", R"("a")"));
  EXPECT_TRUE(names_entity_tag(R"( "x",W/"y" ,"a" )", R"("a")"));
  EXPECT_TRUE(names_entity_tag("*", R"("a")"));
  EXPECT_FALSE(names_entity_tag("", R"("a")"));
  EXPECT_FALSE(names_entity_tag(R"("x", "ab", "A")", R"("a")"));
}

TEST(EntityTag, IsTheSameStrongOrWeak) {
  EXPECT_TRUE(names_entity_tag(R"(W/"a")", R"("a")"));
  EXPECT_TRUE(names_entity_tag(R"("a")", R"(W/"a")"));
  EXPECT_TRUE(names_entity_tag(R"(W/"a")", R"(W/"a")"));
}

TEST(EntityTag, MayHaveCommas) {
  EXPECT_TRUE(names_entity_tag(R"("x,", "a")", R"("a")"));
  EXPECT_TRUE(names_entity_tag(R"("a,b", "c")", R"("a,b")"));
  EXPECT_FALSE(names_entity_tag(R"("x, a", "b")", R"(" a")"));
}

TEST(EntityTag, WhatIsNoTagNamesNothing) {
  for (const char* line : {"a", "\"a", "a\"", "W/a", "**", ",", ",,,", "\"", "W/", "\"\"", "w/\"a\""}) {
    EXPECT_FALSE(names_entity_tag(line, R"("a")")) << line;
  }
}

}  // namespace
}  // namespace mapweld::server
