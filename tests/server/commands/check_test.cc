#include "server/commands/check.h"

#include <string>

#include <CLI/CLI.hpp>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/temp_store.h"

namespace mapweld::test {
namespace {

using ::testing::HasSubstr;

struct Checked {
  int exit_code = 0;
  std::string output;
  std::string errors;
};

Checked check(const std::string& data) {
  CLI::App app;
  server::add_check_command(app);
  Checked run;
  ::testing::internal::CaptureStdout();
  ::testing::internal::CaptureStderr();
  try {
    app.parse("check --data " + data);
  } catch (const CLI::RuntimeError& error) {
    run.exit_code = error.get_exit_code();
  }
  run.output = ::testing::internal::GetCapturedStdout();
  run.errors = ::testing::internal::GetCapturedStderr();
  return run;
}

TEST(CheckCommand, FindsAWholeFolderInOrderAlsoBesideAServer) {
  TempStore store;
  const VocabularyId vocabulary = add_vocabulary(store);
  Random random(1);
  add_vertex(store, add_map(store, "lab", vocabulary), vocabulary, "a", random_appearances(random, 50, 1000));
  const Checked run = check((store.folder() / "data").string());
  EXPECT_EQ(run.exit_code, 0) << run.output << run.errors;
  EXPECT_THAT(run.output, HasSubstr("1 maps, 1 images"));
  EXPECT_THAT(run.output, HasSubstr("all in order"));
}

TEST(CheckCommand, NamesWhatIsDamaged) {
  TempStore store;
  const VocabularyId vocabulary = add_vocabulary(store);
  Random random(1);
  add_vertex(store, add_map(store, "lab", vocabulary), vocabulary, "a", random_appearances(random, 50, 1000));
  {
    WriteTransaction db = store.write();
    db.prepare("UPDATE maps SET vertices = 7").run();
    db.commit();
  }
  const Checked run = check((store.folder() / "data").string());
  EXPECT_EQ(run.exit_code, 1);
  EXPECT_THAT(run.output, HasSubstr("findings"));
  EXPECT_THAT(run.output, HasSubstr("lab"));
}

TEST(CheckCommand, SaysWhyAFolderCannotBeRead) {
  const TempFolder folder;
  const Checked run = check((folder.path() / "nothing").string());
  EXPECT_EQ(run.exit_code, 2);
  EXPECT_THAT(run.errors, HasSubstr("mapweld-server: "));
}

}  // namespace
}  // namespace mapweld::test
