// The power is cut at random calls of a store that writes. What was committed must be there, and all of it whole.
//
// MAPWELD_POWER_CUTS says how many times; MAPWELD_SEED draws others.
#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <iostream>
#include <stdexcept>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <sqlite3.h>

#include "schema/merges/merge_state_store.h"
#include "schema/merges/merge_store.h"
#include "schema/segments/segment_store.h"
#include "schema/store_check.h"
#include "tests/schema/engine/power_cut_vfs.h"
#include "tests/support/temp_store.h"

namespace mapweld {
namespace {

namespace fs = std::filesystem;
using test::Random;

std::uint64_t number_from(const char* variable, std::uint64_t otherwise) {
  const char* text = std::getenv(variable);
  return text != nullptr ? std::strtoull(text, nullptr, 10) : otherwise;
}

// What is in a store, as far as this test writes it.
struct Content {
  std::uint32_t vertices = 0;  // of map "a", called "0", "1", ...
  std::uint64_t step = 0;      // of the merge
  bool passing = false;        // whether there is a map "passing"
  bool operator==(const Content&) const = default;
};

struct Ids {
  VocabularyId vocabulary{};
  MapId map{};
  JobId job{};
};

DataFolderOptions options() {
  DataFolderOptions options;
  options.store.checkpoint_pages = 30;
  options.store.restart_pages = 90;
  return options;
}

Ids fill(const fs::path& folder) {
  Ids ids;
  DataFolder data(folder, options());
  ids.vocabulary = test::add_vocabulary(data.store());
  ids.map = test::add_map(data.store(), "a", ids.vocabulary);
  const MapId b = test::add_map(data.store(), "b", ids.vocabulary);
  WriteTransaction db = data.store().write();
  const MapId merged = insert_merged_map(db, test::new_map("ab", ids.vocabulary), std::vector{ids.map, b});
  ids.job = insert_merge(db, {merged, "quickconnect", 7, "{}", "{}", test::at(0)});
  db.commit();
  return ids;
}

MergeState state_at(std::uint64_t step) {
  MergeState state;
  state.method = "quickconnect";
  state.step = step;
  state.search.priorities.assign(500, static_cast<std::uint32_t>(step));
  state.search.word_processed.assign(500, step % 2);
  state.search.postponed.assign(50, {VertexId{0}, VertexId{1}, static_cast<std::uint32_t>(step)});
  return state;
}

// Two contents: of what was committed, and of that and the commit that was under way when the power went.
struct Promise {
  Content committed;
  Content perhaps;
};

// Writes until the power is gone; begins with `content`.
Promise write_until_cut(const fs::path& folder, const Ids& ids, const Content& content, Random& random) {
  Promise promise{content, content};
  try {
    DataFolder data(folder, options());
    Store& store = data.store();
    std::uint64_t epoch = 0;
    {
      WriteTransaction db = store.write();
      recover_merges(db, test::at(1));
      epoch = claim_merge(db, ids.job, test::at(2)).value();
      db.commit();
    }
    while (true) {
      Content& next = promise.perhaps;
      const std::uint64_t what = random.below(10);
      WriteTransaction db = store.write();
      if (what < 6) {
        const AppearanceVector appearances = test::random_appearances(random, 60, 1'000);
        insert_vertex(db, ids.map, ids.vocabulary, test::new_image(std::to_string(next.vertices), appearances),
                      appearances, {}, test::test_verifier(db));
        ++next.vertices;
      } else if (what < 8) {
        test::save_state(db, ids.job, epoch, state_at(++next.step));
      } else if (!next.passing) {
        insert_map(db, test::new_map("passing", ids.vocabulary));
        next.passing = true;
      } else {
        delete_map(db, find_map(db, "passing")->id);
        next.passing = false;
      }
      db.commit();
      promise.committed = next;
      if (what == 0) write_due_segments(store, {8, 3, 72});
    }
  } catch (const StoreError&) {
    return promise;
  }
}

// What a store that is opened after the cut has; adds to `findings` what is wrong with it.
Content content_after(const fs::path& folder, const Ids& ids, std::string& findings) {
  DataFolder data(folder, options());
  const ReadTransaction db = data.store().read();
  for (const Finding& finding : check_store(db).findings) {
    findings += finding.where + ": " + finding.what + "\n";
  }
  const std::uint64_t step = find_merge(db, ids.job).value().step;
  if (step > 0 && load_merge_state(db, ids.job) != state_at(step)) findings += "the merge's state is another\n";
  return {
      .vertices = find_map(db, ids.map).value().vertices, .step = step, .passing = find_map(db, "passing").has_value()};
}

struct Outcome {
  std::uint64_t cuts = 0;
  std::uint64_t commits_cut = 0;  // cuts that left the commit under way: it was whole on the disk
  std::uint64_t lost = 0;
  std::string first_loss;
};

// Cuts so often, or until something was lost.
Outcome cut_power(std::uint64_t cuts, std::uint64_t seed) {
  constexpr std::uint64_t kRoundsOfAFolder = 50;
  Outcome outcome;
  Random random(seed);
  while (outcome.cuts < cuts && outcome.lost == 0) {
    const test::TempFolder folder;
    const Ids ids = fill(folder.path());
    Content content;
    for (std::uint64_t round = 0; round < kRoundsOfAFolder && outcome.cuts < cuts; ++round) {
      Promise promise;
      {
        test::PowerCutVfs vfs([&](std::uint64_t below) { return random.below(below); });
        vfs.cut_at(1 + random.below(160));
        promise = write_until_cut(folder.path(), ids, content, random);
        if (!vfs.is_off()) throw std::logic_error("it ended before the power was cut");
        vfs.restore();
      }
      ++outcome.cuts;
      std::string findings;
      try {
        content = content_after(folder.path(), ids, findings);
        if (content == promise.perhaps && content != promise.committed) ++outcome.commits_cut;
        if (content != promise.committed && content != promise.perhaps) findings += "another content";
      } catch (const std::exception& error) {
        findings += error.what();
      }
      if (findings.empty()) continue;
      ++outcome.lost;
      outcome.first_loss = "cut " + std::to_string(outcome.cuts) + ": " + findings;
      break;
    }
  }
  return outcome;
}

TEST(PowerCut, WhatWasCommittedIsThereAndWholeAfterEveryCut) {
  const std::uint64_t cuts = number_from("MAPWELD_POWER_CUTS", 300);
  const Outcome outcome = cut_power(cuts, number_from("MAPWELD_SEED", 17));
  EXPECT_EQ(outcome.lost, 0U) << outcome.first_loss;
  EXPECT_EQ(outcome.cuts, cuts);
  std::cout << "power_cut: " << outcome.cuts << " cuts, " << outcome.commits_cut
            << " of them left a commit that was under way, " << outcome.lost << " lost something\n";
}

// As every connection would be with synchronous = OFF, whatever it asks for.
int open_without_sync(sqlite3* connection, char**, const sqlite3_api_routines*) {
  sqlite3_exec(connection, "PRAGMA synchronous = OFF", nullptr, nullptr, nullptr);
  const auto ignore_synchronous = [](void*, int action, const char* name, const char* value, const char*,
                                     const char*) -> int {
    const bool sets = action == SQLITE_PRAGMA && value != nullptr && sqlite3_stricmp(name, "synchronous") == 0;
    return sets ? SQLITE_IGNORE : SQLITE_OK;
  };
  return sqlite3_set_authorizer(connection, ignore_synchronous, nullptr);
}

TEST(PowerCut, WithoutSyncingItLosesSomething) {
  // What SQLite takes is the entry of a loadable extension, whatever its parameters.
  const auto entry = reinterpret_cast<void (*)()>(open_without_sync);
  sqlite3_auto_extension(entry);
  const Outcome outcome = cut_power(300, 17);
  sqlite3_cancel_auto_extension(entry);
  EXPECT_EQ(outcome.lost, 1U) << "the cuts are none, or nothing is compared";
  std::cout << "power_cut: with synchronous = OFF, " << outcome.first_loss << "\n";
}

// Whose process died then: another one opens what stands in the files.
TEST(FailedSync, ACommitThatFailedIsNotFoundByTheNextProcess) {
  const test::TempFolder folder;
  const Ids ids = fill(folder.path() / "data");
  test::PowerCutVfs vfs([](std::uint64_t) { return 0; });
  DataFolder data(folder.path() / "data", options());
  test::add_map(data.store(), "committed", ids.vocabulary);
  vfs.fail_next_sync();
  try {
    test::add_map(data.store(), "failed", ids.vocabulary);
    FAIL() << "no sync was asked for";
  } catch (const StoreError& error) {
    EXPECT_EQ(error.kind(), StoreErrorKind::kIo);
  }
  fs::copy(folder.path() / "data", folder.path() / "found");
  fs::remove(folder.path() / "found/mapweld.db-shm");
  DataFolder found(folder.path() / "found", options());
  const ReadTransaction db = found.store().read();
  EXPECT_TRUE(find_map(db, "committed"));
  EXPECT_FALSE(find_map(db, "failed"));
  EXPECT_TRUE(check_store(db).findings.empty());
  test::add_map(data.store(), "failed", ids.vocabulary);  // and this one goes on
}

}  // namespace
}  // namespace mapweld
