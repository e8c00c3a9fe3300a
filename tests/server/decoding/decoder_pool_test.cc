#include "server/decoding/decoder_pool.h"

#include <array>
#include <chrono>
#include <csignal>
#include <ctime>
#include <future>
#include <string>
#include <thread>
#include <vector>

#include <gtest/gtest.h>
#include <opencv2/core.hpp>

#include "core/errors.h"
#include "tests/core/feature/image_files.h"
#include "tests/core/feature/png_files.h"

namespace mapweld::server {
namespace {

using test::Bytes;

DecoderPoolOptions real(int processes = 1) { return {.program = MAPWELD_SERVER, .processes = processes}; }

std::string message_of(ImageDecoder& decoder, const Bytes& file) {
  try {
    decoder.decode(file, true);
    return "decoded";
  } catch (const ImageError& error) {
    return error.code() + ": " + error.what();
  }
}

bool same(const cv::Mat& a, const cv::Mat& b) {
  return a.size() == b.size() && a.type() == b.type() && (a.empty() || cv::norm(a, b, cv::NORM_INF) == 0);
}

double processor_s(int process) {
  clockid_t clock{};
  timespec time{};
  ::clock_getcpuclockid(process, &clock);
  ::clock_gettime(clock, &time);
  return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
}

// Several tenths of a second to decode.
Bytes large_png() {
  cv::Mat noise(3900, 4000, CV_8UC3);
  cv::randu(noise, 0, 255);
  return test::encode(".png", noise);
}

TEST(DecoderPool, GivesThePixelsThatThisProcessWould) {
  DecoderPool pool(real());
  LocalDecoder local;
  const cv::Mat picture = test::textured_image(320, 240);
  const Bytes transparent =
      test::encode_png({.width_px = 50, .height_px = 40, .colour = test::PngColour::kGreyAlpha}, [](int x, int y) {
        return std::array<std::uint16_t, 4>{static_cast<std::uint16_t>((x * 7 + y * 13) % 256),
                                            static_cast<std::uint16_t>(x < 9 ? 0 : 255), 0, 0};
      });
  // Large enough that its memory is given back at once.
  const Bytes large = test::encode(".jpg", test::textured_image(2600, 2000));
  const Bytes files[] = {large,
                         test::encode(".jpg", picture),
                         test::encode(".png", picture),
                         transparent,
                         test::with_jpeg_exif(test::encode(".jpg", picture), test::exif_block(6, true)),
                         test::encode(".jpg", cv::Mat(picture / 16))};
  for (const Bytes& file : files) {
    for (const bool stretch : {true, false}) {
      const DecodedImage there = pool.decode(file, stretch);
      const DecodedImage here = local.decode(file, stretch);
      EXPECT_TRUE(same(there.grey, here.grey));
      EXPECT_TRUE(same(there.used, here.used));
      EXPECT_EQ(there.format, here.format);
    }
  }
  EXPECT_FALSE(pool.decode(transparent, true).used.empty());
  EXPECT_EQ(pool.replaced(), 0u);
}

TEST(DecoderPool, ShrinksAsThisProcessWould) {
  DecoderPool pool(real());
  LocalDecoder local;
  const cv::Mat picture = test::textured_image(2600, 2000);
  const Bytes files[] = {test::encode(".jpg", picture), test::encode(".png", picture),
                         test::with_jpeg_exif(test::encode(".jpg", picture), test::exif_block(6, true))};
  for (const Bytes& file : files) {
    for (const int width_px : {16, 320, 2599, 4096})
      EXPECT_EQ(pool.shrink(file, width_px), local.shrink(file, width_px));
  }
  EXPECT_EQ(pool.replaced(), 0u);
  EXPECT_THROW(pool.shrink({}, 16), ImageError);
  EXPECT_EQ(message_of(pool, files[0]), "decoded");
}

TEST(DecoderPool, RefusesInTheSameWords) {
  DecoderPool pool(real());
  LocalDecoder local;
  Bytes cut = test::encode(".jpg", test::textured_image(320, 240));
  cut.resize(cut.size() / 2);
  for (const Bytes& file : {Bytes{}, Bytes{'G', 'I', 'F'}, cut, test::png_claiming(20000, 10)}) {
    EXPECT_EQ(message_of(pool, file), message_of(local, file));
  }
  EXPECT_EQ(message_of(pool, test::encode(".png", test::textured_image(64, 48))), "decoded");
  EXPECT_EQ(pool.replaced(), 0u);
}

TEST(DecoderPool, AProcessThatDiedIsReplacedAndNoImageIsLost) {
  DecoderPool pool(real(2));
  const Bytes file = test::encode(".jpg", test::textured_image(320, 240));
  const std::vector<int> processes = pool.process_ids();
  ASSERT_EQ(processes.size(), 2u);
  for (const int process : processes) ::kill(process, SIGKILL);
  std::this_thread::sleep_for(std::chrono::milliseconds(50));
  for (int i = 0; i < 4; ++i) EXPECT_EQ(message_of(pool, file), "decoded");
  EXPECT_GE(pool.replaced(), 1u);
}

TEST(DecoderPool, AFileThatKillsItsProcessCostsThatFileAlone) {
  DecoderPool pool(real());
  const Bytes large = large_png();
  const int process = pool.process_ids().at(0);
  auto outcome = std::async(std::launch::async, [&] { return message_of(pool, large); });
  const double idle_s = processor_s(process);
  while (processor_s(process) < idle_s + 0.05) std::this_thread::yield();  // it is at it
  ::kill(process, SIGKILL);
  EXPECT_EQ(outcome.get(), "undecodable_image: The decoder broke off over this image.");
  EXPECT_EQ(pool.replaced(), 1u);
  EXPECT_EQ(message_of(pool, test::encode(".png", test::textured_image(64, 48))), "decoded");
}

TEST(DecoderPool, AnImageThatTakesTooLongIsBrokenOff) {
  DecoderPoolOptions options = real();
  options.max_processor_s = 0.001;
  DecoderPool pool(options);
  EXPECT_EQ(message_of(pool, large_png()), "undecodable_image: The image takes longer to decode than an image may.");
  EXPECT_EQ(pool.replaced(), 1u);
}

TEST(DecoderPool, AProgramThatCannotDecodeIsAnErrorEachTime) {
  DecoderPool pool({.program = "/bin/false", .processes = 2});
  const Bytes file = test::encode(".png", test::textured_image(64, 48));
  for (int i = 0; i < 5; ++i) EXPECT_TRUE(message_of(pool, file).starts_with("undecodable_image"));
}

TEST(DecoderPool, ManyImagesAtOnce) {
  DecoderPool pool(real(2));
  LocalDecoder local;
  std::vector<std::thread> threads;
  for (int t = 0; t < 4; ++t) {
    threads.emplace_back([&, t] {
      for (int i = 0; i < 20; ++i) {
        const Bytes file = test::encode(".jpg", test::textured_image(120 + i, 90, static_cast<std::uint64_t>(t)));
        EXPECT_TRUE(same(pool.decode(file, true).grey, local.decode(file, true).grey));
      }
    });
  }
  for (std::thread& thread : threads) thread.join();
}

}  // namespace
}  // namespace mapweld::server
