#include "schema/engine/database.h"

#include <algorithm>
#include <fstream>
#include <functional>

#include <gtest/gtest.h>

#include "tests/support/temp_store.h"

namespace mapweld::sqlite {
namespace {

using test::TempFolder;

StoreErrorKind kind_thrown(const std::function<void()>& what) {
  try {
    what();
  } catch (const StoreError& error) {
    return error.kind();
  }
  ADD_FAILURE() << "nothing was thrown";
  return StoreErrorKind::kInternal;
}

class DatabaseTest : public testing::Test {
 protected:
  TempFolder folder_;
  Connection connection_{folder_.path() / "a.db", OpenMode::kCreate};
};

TEST_F(DatabaseTest, ValuesComeBackAsTheyWereBound) {
  connection_.execute("CREATE TABLE t (i INTEGER, r REAL, s TEXT, b BLOB, n INTEGER) STRICT");
  const std::vector<std::uint8_t> blob = {0, 1, 255, 0};
  const std::string text("a\0b", 3);
  connection_.prepare("INSERT INTO t VALUES (?, ?, ?, ?, ?)")
      .bind_all(std::int64_t{-5'000'000'000}, 0.1, text, std::span<const std::uint8_t>(blob),
                std::optional<std::int64_t>())
      .run();
  Statement row = connection_.prepare("SELECT i, r, s, b, n FROM t");
  ASSERT_TRUE(row.step());
  EXPECT_EQ(row.integer(0), -5'000'000'000);
  EXPECT_EQ(row.real(1), 0.1);
  EXPECT_EQ(row.text(2), text);
  EXPECT_TRUE(std::ranges::equal(row.blob(3), blob));
  EXPECT_TRUE(row.is_null(4));
  EXPECT_EQ(row.optional_integer(4), std::nullopt);
  EXPECT_FALSE(row.step());
}

TEST_F(DatabaseTest, EmptyTextAndBlobsAreNotNull) {
  connection_.execute("CREATE TABLE t (s TEXT NOT NULL, b BLOB NOT NULL) STRICT");
  connection_.prepare("INSERT INTO t VALUES (?, ?)")
      .bind_all(std::string_view(), std::span<const std::uint8_t>())
      .run();
  Statement row = connection_.prepare("SELECT s, b FROM t");
  ASSERT_TRUE(row.step());
  EXPECT_EQ(row.text(0), "");
  EXPECT_TRUE(row.blob(1).empty());
}

TEST_F(DatabaseTest, AStatementFromTheCacheHasNoBindingsLeft) {
  connection_.execute("CREATE TABLE t (i INTEGER) STRICT");
  connection_.prepare("INSERT INTO t VALUES (?)").bind(1, 7).run();
  connection_.prepare("INSERT INTO t VALUES (?)").run();
  EXPECT_EQ(connection_.query_integer("SELECT count(*) FROM t WHERE i IS NULL"), 1);
}

TEST_F(DatabaseTest, TheSameStatementMayBeUsedInsideItself) {
  connection_.execute("CREATE TABLE t (i INTEGER) STRICT; INSERT INTO t VALUES (1), (2), (3)");
  int pairs = 0;
  Statement outer = connection_.prepare("SELECT i FROM t");
  while (outer.step()) {
    Statement inner = connection_.prepare("SELECT i FROM t");
    while (inner.step()) ++pairs;
  }
  EXPECT_EQ(pairs, 9);
}

TEST_F(DatabaseTest, ATransactionThatIsNotCommittedIsRolledBack) {
  connection_.execute("CREATE TABLE t (i INTEGER) STRICT");
  {
    Transaction transaction(connection_, Transaction::Kind::kWrite);
    connection_.execute("INSERT INTO t VALUES (1)");
  }
  EXPECT_FALSE(connection_.in_transaction());
  EXPECT_EQ(connection_.query_integer("SELECT count(*) FROM t"), 0);
  {
    Transaction transaction(connection_, Transaction::Kind::kWrite);
    connection_.execute("INSERT INTO t VALUES (1)");
    transaction.commit();
    EXPECT_TRUE(transaction.finished());
    transaction.rollback();
    EXPECT_EQ(kind_thrown([&] { transaction.commit(); }), StoreErrorKind::kInternal);
  }
  EXPECT_EQ(connection_.query_integer("SELECT count(*) FROM t"), 1);
}

TEST_F(DatabaseTest, AFailedStatementCanBeRunAgain) {
  connection_.execute("CREATE TABLE t (i INTEGER UNIQUE) STRICT; INSERT INTO t VALUES (1)");
  Statement insert = connection_.prepare("INSERT INTO t VALUES (?)");
  EXPECT_EQ(kind_thrown([&] { insert.bind(1, 1).run(); }), StoreErrorKind::kConstraint);
  insert.bind(1, 2).run();
  EXPECT_EQ(connection_.query_integer("SELECT count(*) FROM t"), 2);
}

TEST_F(DatabaseTest, ErrorsHaveTheirKinds) {
  EXPECT_EQ(kind_thrown([&] { connection_.prepare("SELECT nonsense FROM nowhere"); }), StoreErrorKind::kInternal);
  EXPECT_EQ(kind_thrown([&] { Connection(folder_.path() / "missing.db", OpenMode::kReadWrite); }),
            StoreErrorKind::kNoPermission);
  connection_.execute("CREATE TABLE t (b BLOB) STRICT; PRAGMA max_page_count = 8");
  EXPECT_EQ(kind_thrown([&] { connection_.execute("INSERT INTO t VALUES (zeroblob(100000))"); }),
            StoreErrorKind::kNoSpace);

  std::ofstream(folder_.path() / "text.db") << std::string(5'000, 'x');
  EXPECT_EQ(kind_thrown([&] {
              Connection(folder_.path() / "text.db", OpenMode::kReadWrite).query_integer("PRAGMA user_version");
            }),
            StoreErrorKind::kForeignDatabase);
}

TEST_F(DatabaseTest, AnotherWriterIsWaitedForAndThenReportedBusy) {
  connection_.execute("CREATE TABLE t (i INTEGER) STRICT");
  Connection other(folder_.path() / "a.db", OpenMode::kReadWrite);
  other.set_busy_timeout_ms(20);
  const Transaction held(connection_, Transaction::Kind::kWrite);
  EXPECT_EQ(kind_thrown([&] { const Transaction late(other, Transaction::Kind::kWrite); }), StoreErrorKind::kBusy);
}

TEST_F(DatabaseTest, AReadOnlyConnectionDoesNotWrite) {
  connection_.execute("CREATE TABLE t (i INTEGER) STRICT");
  Connection reader(folder_.path() / "a.db", OpenMode::kReadOnly);
  EXPECT_EQ(kind_thrown([&] { reader.execute("INSERT INTO t VALUES (1)"); }), StoreErrorKind::kNoPermission);
}

}  // namespace
}  // namespace mapweld::sqlite
