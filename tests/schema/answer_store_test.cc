#include "schema/answer_store.h"

#include <gtest/gtest.h>

#include "tests/support/temp_store.h"

namespace mapweld {
namespace {

using test::at;

class AnswerStore : public ::testing::Test {
 protected:
  static KeptAnswer answer(const std::string& body, int time_s, std::int64_t part = 0, std::optional<MapId> map = {}) {
    KeptAnswer answer;
    answer.part = part;
    answer.request.fill(7);
    answer.status = 201;
    answer.headers = "Location: /v1/maps/a\n";
    answer.body = body;
    answer.map = map;
    answer.kept_at = at(time_s);
    return answer;
  }
  void keep(const AnswerKey& key, const KeptAnswer& answer) {
    WriteTransaction db = store_.write();
    keep_answer(db, key, answer);
    db.commit();
  }
  // The bodies under a key.
  std::string bodies(const AnswerKey& key, int since_s = 0) {
    std::string all;
    for (const KeptAnswer& found : find_answers(store_.read(), key, at(since_s))) all += found.body + " ";
    return all;
  }

  test::TempStore store_;
};

TEST_F(AnswerStore, GivesBackWhatWasKept) {
  const KeptAnswer kept = answer("{\"name\":\"a\"}", 5, 3, MapId{9});
  keep({1, "key"}, kept);
  const std::vector<KeptAnswer> found = find_answers(store_.read(), {1, "key"}, at(5));
  ASSERT_EQ(found.size(), 1u);
  EXPECT_EQ(found[0].part, 3);
  EXPECT_EQ(found[0].request, kept.request);
  EXPECT_EQ(found[0].status, 201);
  EXPECT_EQ(found[0].headers, kept.headers);
  EXPECT_EQ(found[0].body, kept.body);
  EXPECT_EQ(found[0].map, MapId{9});
  EXPECT_EQ(found[0].kept_at, at(5));
}

TEST_F(AnswerStore, AKeyIsItsCallersAndHasPartsAndAnAge) {
  keep({1, "key"}, answer("second", 5, 1));
  keep({1, "key"}, answer("first", 5, 0));
  keep({2, "key"}, answer("another's", 5));
  EXPECT_EQ(bodies({1, "key"}), "first second ");
  EXPECT_EQ(bodies({2, "key"}), "another's ");
  EXPECT_EQ(bodies({1, "KEY"}), "");
  EXPECT_EQ(bodies({1, "key"}, 6), "");
  keep({1, "key"}, answer("anew", 8, 0));
  EXPECT_EQ(bodies({1, "key"}, 6), "anew ");
}

TEST_F(AnswerStore, DropsTheOldestFirstAndNoMoreThanTold) {
  for (int i = 0; i < 10; ++i) keep({1, "key-" + std::to_string(i)}, answer("x", i));
  WriteTransaction db = store_.write();
  drop_answers(db, at(8), 3);
  db.commit();
  const auto left = [&] { return store_.read().connection().query_integer("SELECT count(*) FROM kept_answers"); };
  EXPECT_EQ(left(), 7);
  EXPECT_EQ(bodies({1, "key-2"}), "");
  EXPECT_EQ(bodies({1, "key-3"}), "x ");
  WriteTransaction again = store_.write();
  drop_answers(again, at(8), 100);
  again.commit();
  EXPECT_EQ(left(), 2);
}

TEST_F(AnswerStore, DropsWhatTellsOfAMap) {
  const VocabularyId vocabulary = test::add_vocabulary(store_);
  const MapId a = test::add_map(store_, "a", vocabulary);
  const MapId b = test::add_map(store_, "b", vocabulary);
  keep({1, "a"}, answer("of a", 1, 0, a));
  keep({1, "b"}, answer("of b", 1, 0, b));
  keep({1, "gone"}, answer("of one that is gone", 1, 0, MapId{77}));
  keep({1, "none"}, answer("of none", 1));
  WriteTransaction db = store_.write();
  drop_answers_of(db, a);
  db.commit();
  EXPECT_EQ(bodies({1, "a"}), "");
  EXPECT_EQ(bodies({1, "gone"}), "of one that is gone ");
  WriteTransaction again = store_.write();
  drop_answers_of_deleted_maps(again);
  again.commit();
  EXPECT_EQ(bodies({1, "gone"}) + bodies({1, "b"}) + bodies({1, "none"}), "of b of none ");
}

}  // namespace
}  // namespace mapweld
