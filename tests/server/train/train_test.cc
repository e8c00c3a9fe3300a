#include "server/training/train.h"

#include <filesystem>
#include <optional>
#include <sstream>
#include <string>
#include <utility>

#include <CLI/CLI.hpp>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/errors.h"
#include "core/feature/decode.h"
#include "core/feature/extractor.h"
#include "core/vocabulary/vocabulary.h"
#include "server/training/descriptor_file.h"
#include "server/training/training.h"
#include "tests/core/feature/image_files.h"
#include "tests/core/vocabulary/descriptor_sets.h"

namespace mapweld {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

class Training : public testing::Test {
 protected:
  void SetUp() override {
    folder_ = fs::path(testing::TempDir()) / ("mapweld-train-" + std::to_string(getpid()) + "-" +
                                              testing::UnitTest::GetInstance()->current_test_info()->name());
    fs::remove_all(folder_);
    fs::create_directories(folder_ / "images" / "deeper");
  }
  void TearDown() override { fs::remove_all(folder_); }

  void write(const fs::path& name, const test::Bytes& bytes) const { replace_file(folder_ / name, bytes); }

  // 130 small images, three of which cannot be read; 2 held out.
  void write_images() const {
    for (int i = 0; i < 130; ++i) {
      char name[32];
      std::snprintf(name, sizeof name, "images/%s%03d.%s", i % 2 == 0 ? "deeper/" : "", i, i % 3 == 0 ? "png" : "JPG");
      const test::Bytes bytes =
          test::encode(i % 3 == 0 ? ".png" : ".jpg", test::textured_image(64, 48, static_cast<std::uint64_t>(i)));
      write(name, bytes);
    }
    write("images/007.JPG", {'n', 'o', ' ', 'i', 'm', 'a', 'g', 'e'});
    write("images/deeper/008.JPG", {});
    const test::Bytes whole = test::encode(".jpg", test::textured_image(64, 48));
    write("images/011.JPG", test::Bytes(whole.begin(), whole.begin() + 600));
    write("images/notes.txt", {'x'});
  }

  TrainingOptions small(const std::string& work) const {
    TrainingOptions options;
    options.images = {folder_ / "images"};
    options.work = folder_ / work;
    options.iterations = 3;
    options.trainer.words = 60;
    options.trainer.start_sample = 1000;
    options.trainer.block = 400;
    return options;
  }

  fs::path folder_;
};

TEST_F(Training, FindsImagesAtAnyDepthInOrder) {
  write_images();
  const auto images = find_images({folder_ / "images", folder_ / "images" / "deeper"});
  EXPECT_EQ(images.size(), 130u) << "no text, and nothing twice";
  EXPECT_TRUE(std::is_sorted(images.begin(), images.end()));
  EXPECT_THROW(find_images({folder_ / "nowhere"}), TrainingFileError);
}

TEST_F(Training, MakesAVocabularyAndSkipsWhatItCannotRead) {
  write_images();
  const TrainingOptions options = small("work");
  const auto trained = train_vocabulary(options, {});
  ASSERT_TRUE(trained.has_value());
  const auto vocabulary = Vocabulary::deserialize(trained->file);
  EXPECT_EQ(vocabulary->words(), 60u);

  const TrainingReport& report = trained->report;
  EXPECT_EQ(report.images, 127u);
  ASSERT_EQ(report.skipped.size(), 3u);
  EXPECT_THAT(report.skipped[0].path, HasSubstr("007.JPG"));
  EXPECT_EQ(report.iterations.size(), 3u);
  EXPECT_LT(report.iterations[2].distortion, report.iterations[0].distortion);
  EXPECT_TRUE(report.evaluated_on_held_out);
  EXPECT_GT(report.evaluation.recall, 0.97);

  std::uint64_t features = 0;
  for (const fs::path& image : find_images(options.images)) {
    try {
      features += extract_features(decode_grey(read_file(image)), {.max_features = 0}).keypoints.size();
    } catch (const ImageError&) {
    }
  }
  EXPECT_EQ(report.descriptors + report.evaluation.descriptors, features) << "each is trained on or held out";

  const std::string text = format_report(report, options);
  EXPECT_THAT(text, HasSubstr("| words | 60 |"));
  EXPECT_THAT(text, HasSubstr("| images skipped | 3 |"));
  EXPECT_THAT(text, HasSubstr("features not trained on"));
  EXPECT_THAT(text, HasSubstr("007.JPG"));
}

TEST_F(Training, ThreadsChangeNothing) {
  write_images();
  TrainingOptions options = small("one");
  const auto one = train_vocabulary(options, {});
  options.work = folder_ / "four";
  options.trainer.threads = 4;
  EXPECT_EQ(train_vocabulary(options, {})->file, one->file);
}

TEST_F(Training, InterruptionsChangeNothing) {
  write_images();
  const auto whole = train_vocabulary(small("whole"), {});
  // Stopped again and again: after a few images, within an iteration (which is lost), between two.
  int runs = 0;
  std::optional<TrainedVocabulary> trained;
  while (!trained) {
    ASSERT_LT(++runs, 100);
    bool extracted = false;
    std::string iteration;
    trained = train_vocabulary(small("pieces"), [&](const std::string& stage, std::uint64_t done, std::uint64_t) {
      if (stage == "features") return !std::exchange(extracted, true);
      if (!stage.starts_with("iteration")) return true;  // FLANN's start cannot be left
      if (runs % 2 == 0) return done < 400;
      if (iteration.empty()) iteration = stage;
      return stage == iteration;
    });
  }
  EXPECT_GE(runs, 7);
  EXPECT_EQ(trained->file, whole->file);
  EXPECT_EQ(trained->report.skipped, whole->report.skipped);
  EXPECT_EQ(trained->report.iterations, whole->report.iterations);
}

TEST_F(Training, GoesOnWithMoreIterations) {
  write_images();
  TrainingOptions options = small("whole");
  options.iterations = 5;
  const auto five = train_vocabulary(options, {});
  options = small("grown");
  options.iterations = 2;
  train_vocabulary(options, {});
  options.iterations = 5;
  EXPECT_EQ(train_vocabulary(options, {})->file, five->file);
}

TEST_F(Training, AWorkFolderServesOneTraining) {
  write_images();
  TrainingOptions options = small("work");
  train_vocabulary(options, {});
  options.trainer.seed = 2;
  EXPECT_THROW(train_vocabulary(options, {}), FormatError);
  options.trainer.seed = 1;
  EXPECT_NO_THROW(train_vocabulary(options, {}));
  write("images/another.png", test::encode(".png", test::textured_image(64, 48, 999)));
  EXPECT_THROW(train_vocabulary(options, {}), FormatError);
}

TEST_F(Training, ATornStateIsNoticed) {
  write_images();
  train_vocabulary(small("work"), {});
  test::Bytes state = read_file(folder_ / "work" / "state");
  state[state.size() / 2] ^= 1;
  replace_file(folder_ / "work" / "state", state);
  EXPECT_THROW(train_vocabulary(small("work"), {}), FormatError);
}

TEST_F(Training, TakesAFileOfDescriptors) {
  const test::Bytes rows = test::clustered_descriptors(5000, 80, 40, 1);
  write("rows", rows);
  TrainingOptions options = small("work");
  options.images.clear();
  options.descriptors = folder_ / "rows";
  const auto trained = train_vocabulary(options, {});
  EXPECT_EQ(trained->report.descriptors, 4900u);
  EXPECT_EQ(trained->report.evaluation.descriptors, 100u);
  EXPECT_EQ(Vocabulary::deserialize(trained->file)->words(), 60u);

  write("rows", test::Bytes(rows.begin(), rows.end() - 1));
  options.work = folder_ / "another";
  EXPECT_THROW(train_vocabulary(options, {}), TrainingFileError);
}

TEST_F(Training, SaysWhenThereAreTooFewFeatures) {
  write("images/one.png", test::encode(".png", test::textured_image(64, 48)));
  TrainingOptions options = small("work");
  options.trainer.words = 10'000;
  EXPECT_THROW(train_vocabulary(options, {}), FormatError);
}

// The command as it is typed.
class TrainCommand : public Training {
 protected:
  static int run(const std::vector<std::string>& arguments) {
    CLI::App app;
    add_train_command(app);
    std::vector<std::string> reversed(arguments.rbegin(), arguments.rend());
    try {
      app.parse(reversed);
    } catch (const CLI::ParseError& error) {
      return app.exit(error, sink_, sink_);
    }
    return 0;
  }
  static inline std::ostringstream sink_;
};

TEST_F(TrainCommand, WritesVocabularyAndReport) {
  write_images();
  const std::string out = (folder_ / "out.mwv").string();
  const std::string report = (folder_ / "report.md").string();
  EXPECT_EQ(run({"train", "--images", (folder_ / "images").string(), "--out", out, "--words", "50", "--iterations", "1",
                 "--report", report}),
            0);
  EXPECT_EQ(Vocabulary::deserialize(read_file(out))->words(), 50u);
  const test::Bytes text = read_file(report);
  EXPECT_THAT(std::string(text.begin(), text.end()), HasSubstr("| words | 50 |"));
  EXPECT_FALSE(fs::exists(out + ".work")) << "intermediate files of its own are removed";
}

TEST_F(TrainCommand, FailsWithACode) {
  EXPECT_EQ(run({"train", "--images", (folder_ / "images").string(), "--out", (folder_ / "out").string()}), 1);
  EXPECT_NE(run({"train", "--out", (folder_ / "out").string()}), 0);
  EXPECT_NE(run({"train", "--images", (folder_ / "nowhere").string(), "--out", (folder_ / "out").string()}), 0);
  EXPECT_NE(run({"train", "--images", (folder_ / "images").string(), "--out", "x", "--words", "0"}), 0);
  EXPECT_FALSE(fs::exists(folder_ / "out"));
}

}  // namespace
}  // namespace mapweld
