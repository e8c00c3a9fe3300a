// Folders into maps: the order of the images, going on after an interruption, and trouble on the way.
#include "client/upload.h"

#include <map>
#include <set>
#include <string>

#include <gtest/gtest.h>

#include "client/image_folder.h"
#include "tests/client/fake_server.h"
#include "tests/client/temporary_folder.h"

namespace mapweld::client {
namespace {

using mapweld::testing::FakeServer;
using mapweld::testing::TemporaryFolder;
using Outcome = UploadedFile::Outcome;

std::vector<std::string> names_in(const FakeServer& server, const std::string& map) {
  std::vector<std::string> names;
  for (const auto& image : server.images(map)) names.push_back(image.name);
  return names;
}

std::string numbered(int i) {
  std::string digits = std::to_string(i);
  return std::string(4 - digits.size(), '0') + digits + ".jpg";
}

struct UploadFixture : ::testing::Test {
  FakeServer server;
  TemporaryFolder folder;

  void write_images(int count) {
    for (int i = 0; i < count; ++i) folder.write(numbered(i), "image " + std::to_string(i));
  }
  UploadOptions options(int threads = 2, int batch = 16) const {
    UploadOptions options;
    options.map = "lab";
    options.directory = folder.path();
    options.threads = threads;
    options.batch_images = batch;
    options.give_up_after_s = 2;
    return options;
  }
  UploadReport upload(const UploadOptions& options, std::vector<UploadedFile>* files = nullptr) {
    Client client(server.url());
    UploadObserver observer;
    if (files != nullptr) observer.file = [=](const UploadedFile& file) { files->push_back(file); };
    return upload_directory(client, options, observer);
  }
};
using Upload = UploadFixture;

TEST(ImageFolder, HasThePhotographsInByteOrder) {
  const TemporaryFolder folder;
  for (const char* name :
       {"b.jpg", "a.PNG", "10.jpeg", "9.jpg", "B.jpg", ".hidden.jpg", "notes.txt", "jpg", "c.jpg.bak"}) {
    folder.write(name, "x");
  }
  std::filesystem::create_directory(folder.path() / "folder.jpg");
  std::filesystem::create_symlink(folder.path() / "b.jpg", folder.path() / "link.jpg");
  std::filesystem::create_symlink(folder.path() / "nowhere", folder.path() / "broken.jpg");
  std::vector<std::string> names;
  for (const auto& path : image_files(folder.path())) names.push_back(path.filename().string());
  EXPECT_EQ(names, (std::vector<std::string>{"10.jpeg", "9.jpg", "B.jpg", "a.PNG", "b.jpg", "link.jpg"}));
  EXPECT_THROW(image_files(folder.path() / "none"), std::filesystem::filesystem_error);
}

TEST(Sha256, MatchesFips180) {
  EXPECT_EQ(sha256_hex("abc"), "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
  EXPECT_EQ(sha256_hex(""), "e3b0c44298fc1c149afbf4c8996fb92427ae41e4649b934ca495991b7852b855");
}

TEST(ReadAheadOrder, IsTheSameForAnyNumberOfThreads) {
  const TemporaryFolder folder;
  std::vector<std::filesystem::path> paths;
  for (int i = 0; i < 100; ++i) paths.push_back(folder.write(numbered(i), std::string(i % 7 * 10000, 'x')));
  paths.insert(paths.begin() + 50, folder.path() / "missing.jpg");
  for (const int threads : {1, 2, 8}) {
    for (const std::size_t ahead : {1U, 3U, 200U}) {
      ReadAhead files(paths, threads, ahead, [](const auto& path) { return path.filename() == "0003.jpg"; });
      for (const auto& path : paths) {
        const auto file = files.next();
        ASSERT_TRUE(file);
        EXPECT_EQ(file->path, path);
        EXPECT_EQ(file->error.empty(), path.filename() != "missing.jpg");
        EXPECT_EQ(file->sha256.has_value(), path.filename() == "0003.jpg");
      }
      EXPECT_FALSE(files.next());
    }
  }
  const ReadAhead abandoned(paths, 4, 2, [](const auto&) { return true; });
}

TEST_F(Upload, GoesInNameOrderForAnyNumberOfThreads) {
  write_images(101);
  std::vector<std::string> expected;
  for (int i = 0; i < 101; ++i) expected.push_back(numbered(i));
  for (const int threads : {1, 2, 8}) {
    UploadOptions with = options(threads);
    with.map = "lab-" + std::to_string(threads);
    std::vector<UploadedFile> files;
    const UploadReport report = upload(with, &files);
    EXPECT_EQ(report.inserted, 101);
    EXPECT_EQ(names_in(server, with.map), expected);
    ASSERT_EQ(files.size(), 101U);
    for (int i = 0; i < 101; ++i) EXPECT_EQ(files[static_cast<std::size_t>(i)].name, numbered(i));
  }
  EXPECT_EQ(server.requests_of("POST /v1/maps/lab-1/images/batch"), 7U);
}

TEST_F(Upload, SkipsWhatTheMapHasInsertedOrIgnored) {
  write_images(20);
  folder.write("0005.jpg", "dup of another");
  EXPECT_EQ(upload(options()).ignored, 1);
  const std::size_t posts = server.requests_of("POST");
  folder.write("0020.jpg", "new");
  std::vector<UploadedFile> files;
  const UploadReport again = upload(options(), &files);
  EXPECT_EQ(again.skipped, 20);
  EXPECT_EQ(again.inserted, 1);
  EXPECT_EQ(again.settled(), again.files);
  EXPECT_EQ(server.requests_of("POST"), posts + 1);
  EXPECT_EQ(files.back().name, "0020.jpg");
  EXPECT_EQ(server.images("lab").size(), 21U);
}

TEST_F(Upload, SendsAChangedFileSoThatTheServerCanRefuseIt) {
  write_images(3);
  upload(options());
  folder.write("0001.jpg", "other bytes");
  std::vector<UploadedFile> files;
  const UploadReport again = upload(options(), &files);
  EXPECT_EQ(again.refused, 1);
  EXPECT_EQ(again.skipped, 2);
  EXPECT_EQ(std::get<contract::Problem>(files[1].item).code, "name_taken");
}

TEST_F(Upload, RefusedImagesDoNotEndIt) {
  write_images(10);
  folder.write("0004.jpg", "bad bytes");
  std::vector<UploadedFile> files;
  const UploadReport report = upload(options(), &files);
  EXPECT_EQ(report.inserted, 9);
  EXPECT_EQ(report.refused, 1);
  EXPECT_EQ(files[4].outcome, Outcome::kRefused);
  EXPECT_EQ(std::get<contract::Problem>(files[4].item).code, "undecodable_image");
}

TEST_F(Upload, AsksAgainAfterABrokenConnection) {
  write_images(40);
  server.break_after_storing(2);
  const UploadReport report = upload(options());
  EXPECT_EQ(report.inserted, 40);
  EXPECT_EQ(report.retries, 2);
  EXPECT_EQ(server.images("lab").size(), 40U);
  // Three requests, of which the first was sent three times.
  std::map<std::string, int> sent;
  for (const std::string& key : server.idempotency_keys()) ++sent[key];
  sent.erase("");  // of those that look
  std::multiset<int> times;
  for (const auto& [key, count] : sent) {
    EXPECT_EQ(key.size(), 32U);
    times.insert(count);
  }
  EXPECT_EQ(times, (std::multiset<int>{1, 1, 3}));
}

TEST_F(Upload, AsksAgainWhenTheServerIsBusyButNotForever) {
  write_images(5);
  server.be_busy(2);
  EXPECT_EQ(upload(options()).inserted, 5);
  server.be_busy(1000);
  folder.write("9999.jpg", "one more");
  UploadOptions impatient = options();
  impatient.give_up_after_s = 0.2;
  EXPECT_THROW(upload(impatient), ServerProblem);
}

TEST_F(Upload, HalvesABatchThatIsTooLarge) {
  write_images(16);
  server.take_at_most(3);
  std::vector<std::string> expected;
  for (int i = 0; i < 16; ++i) expected.push_back(numbered(i));
  EXPECT_EQ(upload(options()).inserted, 16);
  EXPECT_EQ(names_in(server, "lab"), expected);
}

TEST_F(Upload, KeepsABatchWithinItsBytes) {
  for (int i = 0; i < 9; ++i) folder.write(numbered(i), std::string(1000, 'x'));
  UploadOptions small = options();
  small.batch_bytes = 3500;
  EXPECT_EQ(upload(small).inserted, 9);
  EXPECT_EQ(server.requests_of("POST"), 3U);
}

TEST_F(Upload, AwkwardNamesArriveAsTheyAre) {
  const std::vector<std::string> names = {"a \"quoted\".jpg", "a%22.jpg", "a\\b.jpg", "b c.jpg", "\xC3\xA4.jpg"};
  for (const std::string& name : names) folder.write(name, "image " + name);
  folder.write("z\nline.jpg", "x");
  std::vector<UploadedFile> files;
  const UploadReport report = upload(options(), &files);
  EXPECT_EQ(report.inserted, 5);
  EXPECT_EQ(report.refused, 1);
  EXPECT_EQ(std::get<contract::Problem>(files[4].item).code, "invalid_name");
  EXPECT_EQ(names_in(server, "lab"), names);
}

TEST_F(Upload, EndsWhenTheWholeUploadCannotGoOn) {
  write_images(3);
  server.script_problem("POST /v1/maps/lab/images/batch", "map_is_merged", "\"lab\" is a merged map.");
  EXPECT_THROW(upload(options()), ServerProblem);
  server.script_problem("GET /v1/maps/lab/vertices", "no_such_map", "There is no map \"lab\".");
  EXPECT_THROW(upload(options()), ServerProblem);
  UploadOptions wrong = options();
  wrong.batch_images = 65;
  EXPECT_THROW(upload(wrong), std::invalid_argument);
}

TEST_F(Upload, FailsAtOnceWhereNobodyAnswers) {
  write_images(3);
  Client nobody(FakeServer().url());
  EXPECT_THROW(upload_directory(nobody, options()), ConnectionError);
}

}  // namespace
}  // namespace mapweld::client
