// A process that writes is killed at a random moment; what it had acknowledged must be there, and all of it whole.
#include <string>

#include <gtest/gtest.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include "schema/merges/merge_state_store.h"
#include "schema/merges/merge_store.h"
#include "schema/segments/segment_store.h"
#include "schema/store_check.h"
#include "tests/support/temp_store.h"

namespace mapweld {
namespace {

using test::Random;

// Of several parts, all of which tell the step.
MergeState state_at(std::uint64_t step) {
  MergeState state;
  state.method = "quickconnect";
  state.step = step;
  state.search.priorities.assign(2'000, static_cast<std::uint32_t>(step));
  state.search.word_processed.assign(2'000, step % 2);
  state.search.postponed.assign(100, {VertexId{0}, VertexId{1}, static_cast<std::uint32_t>(step)});
  return state;
}

// Writes vertices, segments and checkpoints until it is killed; tells the pipe each vertex that was committed.
[[noreturn]] void write_until_killed(const std::filesystem::path& folder, MapId map, VocabularyId vocabulary, JobId job,
                                     std::uint64_t seed, int acknowledge) {
  try {
    DataFolderOptions options;
    options.store.checkpoint_pages = 30;
    DataFolder data(folder, options);
    Random random(seed);
    std::uint64_t epoch = 0;
    {
      WriteTransaction db = data.store().write();
      recover_merges(db, test::at(1));
      epoch = claim_merge(db, job, test::at(2)).value();
      db.commit();
    }
    std::uint32_t next = find_map(data.store().read(), map)->vertices;
    std::uint64_t step = find_merge(data.store().read(), job)->step;
    for (;; ++next) {
      test::add_vertex(data.store(), map, vocabulary, std::to_string(next),
                       test::random_appearances(random, 60, 1'000));
      if (::write(acknowledge, &next, sizeof next) != sizeof next) ::_exit(1);
      if (next % 16 == 0) write_due_segments(data.store(), {8, 3, 72});
      if (next % 4 == 0) {
        WriteTransaction db = data.store().write();
        test::save_state(db, job, epoch, state_at(++step));
        db.commit();
      }
    }
  } catch (...) {
    ::_exit(2);
  }
}

TEST(Crash, WhatWasAcknowledgedIsThereAndWholeAfterEveryKill) {
  const test::TempFolder folder;
  VocabularyId vocabulary{};
  MapId map{};
  JobId job{};
  {
    DataFolder data(folder.path());
    vocabulary = test::add_vocabulary(data.store());
    map = test::add_map(data.store(), "a", vocabulary);
    const MapId b = test::add_map(data.store(), "b", vocabulary);
    WriteTransaction db = data.store().write();
    const MapId merged = insert_merged_map(db, test::new_map("ab", vocabulary), std::vector{map, b});
    job = insert_merge(db, {merged, "quickconnect", 7, "{}", "{}", test::at(0)});
    db.commit();
  }
  Random random(61);
  std::uint32_t total = 0;
  for (int round = 0; round < 15; ++round) {
    int acknowledge[2];
    ASSERT_EQ(::pipe(acknowledge), 0);
    const pid_t child = ::fork();
    ASSERT_GE(child, 0);
    if (child == 0) {
      ::close(acknowledge[0]);
      write_until_killed(folder.path(), map, vocabulary, job, random.below(1'000'000), acknowledge[1]);
    }
    ::close(acknowledge[1]);
    // Dies somewhere after its n-th acknowledgement.
    std::uint32_t last = 0;
    const std::uint64_t enough = 1 + random.below(40);
    std::uint64_t acknowledged = 0;
    while (acknowledged < enough && ::read(acknowledge[0], &last, sizeof last) == sizeof last) ++acknowledged;
    ::usleep(static_cast<useconds_t>(random.below(3'000)));
    ::kill(child, SIGKILL);
    int status = 0;
    ::waitpid(child, &status, 0);
    ASSERT_TRUE(WIFSIGNALED(status)) << "the child ended by itself: " << status;
    while (::read(acknowledge[0], &last, sizeof last) == sizeof last) ++acknowledged;
    ::close(acknowledge[0]);
    ASSERT_GE(acknowledged, enough);

    DataFolder data(folder.path());
    const ReadTransaction reader = data.store().read();
    const StoreCheckReport report = check_store(reader);
    ASSERT_TRUE(report.findings.empty()) << report.findings[0].where << ": " << report.findings[0].what;
    const std::uint32_t vertices = find_map(reader, map)->vertices;
    // One more may be committed than the child lived to tell.
    ASSERT_GE(vertices, last + 1);
    ASSERT_LE(vertices, last + 2);
    EXPECT_EQ(load_index(reader, map, vocabulary).vertices(), vertices);
    if (const auto state = load_merge_state(reader, job)) {
      EXPECT_EQ(*state, state_at(find_merge(reader, job)->step));
    }
    total = vertices;
  }
  EXPECT_GT(total, 100U);
}

}  // namespace
}  // namespace mapweld
