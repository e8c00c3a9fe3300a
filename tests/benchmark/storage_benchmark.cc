// What storage costs: inserting, voting and starting, on maps of simulated images (docs/storage.md, "Measured").
//
//   storage_benchmark [--images 2000,20000] [--folder DIR] [--zipf 1.0]
//
// Each simulated image has 300 to 500 appearances of 50,000 words drawn by Zipf's law, 15 kB of bytes and 7 edges of 60
// inliers to the images before it. One line a figure.
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <numeric>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>
#include <fcntl.h>
#include <openssl/sha.h>
#include <time.h>
#include <unistd.h>

#include "core/retrieval/voting.h"
#include "schema/segments/segment_store.h"
#include "schema/store_check.h"
#include "tests/support/temp_store.h"

namespace mapweld {
namespace {

using test::Random;

constexpr std::uint32_t kWords = 50'000;

// Of the clock on the wall, and of this thread's work alone: the difference is the disk, and other programs.
struct Moment {
  double wall_ms = 0;
  double cpu_ms = 0;
};

Moment now() {
  timespec cpu{};
  ::clock_gettime(CLOCK_THREAD_CPUTIME_ID, &cpu);
  using namespace std::chrono;
  return {duration<double, std::milli>(steady_clock::now().time_since_epoch()).count(),
          static_cast<double>(cpu.tv_sec) * 1e3 + static_cast<double>(cpu.tv_nsec) / 1e6};
}

// Words by Zipf's law: P(word of rank r) ~ 1 / r^exponent; ranks are spread over the word ids.
class ZipfWords {
 public:
  explicit ZipfWords(double exponent) : cumulative_(kWords) {
    double sum = 0;
    for (std::uint32_t r = 0; r < kWords; ++r) cumulative_[r] = sum += std::pow(r + 1.0, -exponent);
  }
  std::uint32_t draw(Random& random) const {
    const double at = random.unit() * cumulative_.back();
    const auto rank = static_cast<std::uint64_t>(std::ranges::lower_bound(cumulative_, at) - cumulative_.begin());
    return static_cast<std::uint32_t>(rank * 7'919 % kWords);
  }

 private:
  std::vector<double> cumulative_;
};

AppearanceVector simulate(Random& random, const ZipfWords& words) {
  AppearanceVector image = test::random_appearances(random, 300 + static_cast<int>(random.below(201)), kWords);
  for (Appearance& appearance : image.appearances) {
    appearance.word = WordId{words.draw(random)};
    for (auto& part : appearance.signature.bits)
      part = static_cast<std::uint32_t>(random.below(std::uint64_t{1} << 32));
  }
  std::ranges::sort(image.appearances);
  return image;
}

struct Times {
  std::vector<double> wall_ms;
  std::vector<double> cpu_ms;
  void add(const Moment& begin) {
    const Moment end = now();
    wall_ms.push_back(end.wall_ms - begin.wall_ms);
    cpu_ms.push_back(end.cpu_ms - begin.cpu_ms);
  }
};

double quantile(std::vector<double> values, double share) {
  std::ranges::sort(values);
  return values[static_cast<std::size_t>(share * static_cast<double>(values.size() - 1))];
}

void print(const std::string& what, const Times& times) {
  std::printf("  %-58s median %8.2f ms  95%% %8.2f ms   of the processor: median %8.2f ms\n", what.c_str(),
              quantile(times.wall_ms, 0.5), quantile(times.wall_ms, 0.95), quantile(times.cpu_ms, 0.5));
}

void print(const std::string& what, double value, const char* unit) {
  std::printf("  %-58s %15.3f %s\n", what.c_str(), value, unit);
}

void evict_from_page_cache(const std::filesystem::path& file) {
  const int descriptor = ::open(file.c_str(), O_RDONLY | O_CLOEXEC);
  ::fsync(descriptor);
  ::posix_fadvise(descriptor, 0, 0, POSIX_FADV_DONTNEED);
  ::close(descriptor);
}

class StorageBenchmark {
 public:
  StorageBenchmark(std::filesystem::path folder, std::uint32_t images, double zipf)
      : folder_(std::move(folder)), images_(images), words_(zipf) {}

  void run() {
    std::printf("%u images\n", images_);
    fill();
    votes();
    start("warm file", false);
    start("file not in the page cache", true);
    without_segments();
    check();
    remove();
  }

 private:
  void fill() {
    DataFolder data(folder_);
    Store& store = data.store();
    vocabulary_ = test::add_vocabulary(store, "words", kWords);
    map_ = test::add_map(store, "a", vocabulary_);
    Random random(1);
    const auto bytes = test::random_bytes(random, 15'000);
    Sha256 sha256{};
    SHA256(bytes.data(), bytes.size(), sha256.data());
    Times first;
    Times last;
    double segments_ms = 0;
    for (std::uint32_t v = 0; v < images_; ++v) {
      const AppearanceVector image = simulate(random, words_);
      NewImage row = test::new_image(std::to_string(v), image);
      row.bytes = bytes;
      row.sha256 = sha256;
      std::vector<NewEdge> edges;
      for (std::uint32_t e = 1; e <= std::min(v, 7U); ++e) {
        edges.push_back({VertexId{v - e}, {}, 80, test::random_verification(random, 60, 300, 300)});
      }
      const Moment begin = now();
      WriteTransaction db = store.write();
      insert_vertex(db, map_, vocabulary_, row, image, edges, test::test_verifier(db));
      db.commit();
      if (v < 500) first.add(begin);
      if (v + 500 >= images_) last.add(begin);
      if (v % 64 == 63) {
        const Moment before = now();
        write_due_segments(store);
        segments_ms += now().cpu_ms - before.cpu_ms;
      }
    }
    print("insert, commit included, first 500 images", first);
    print("insert, commit included, last 500 images", last);
    print("segments written and merged, per image", segments_ms / images_, "ms of the processor");
    {
      const ReadTransaction db = store.read();
      print("segments", static_cast<double>(list_segments(db, map_, vocabulary_).size()), "");
      sqlite::Statement table = db.prepare(
          "SELECT CASE WHEN tbl_name = name THEN name ELSE tbl_name || ' (indexes)' END AS what, sum(pgsize) "
          "FROM dbstat JOIN sqlite_schema USING (name) GROUP BY what ORDER BY 2 DESC LIMIT 6");
      while (table.step()) {
        print("bytes an image: " + std::string(table.text(0)), table.real(1) / images_, "");
      }
    }
    file_ = store.file();
  }

  void votes() {
    DataFolder data(folder_);
    const ReadTransaction db = data.store().read();
    const MapLayout layout = load_layout(db, map_);
    const InvertedIndex index = load_index(db, layout, vocabulary_);
    print("file", static_cast<double>(std::filesystem::file_size(file_)) / 1e6, "MB");
    print("index in memory", static_cast<double>(index.memory_bytes()) / 1e6, "MB");
    Random random(2);
    Times memory;
    Times stored;
    for (int q = 0; q < 50; ++q) {
      const AppearanceVector query = simulate(random, words_);
      const Moment begin = now();
      const Votes fast = vote(query, index, VoteRule::kMin, 12);
      memory.add(begin);
      const Moment between = now();
      const SegmentPostingSource source(db, layout, vocabulary_);
      const Votes slow = vote(query, source, VoteRule::kMin, 12);
      stored.add(between);
      if (fast.candidates != slow.candidates) throw std::runtime_error("votes differ");
    }
    print("vote, index in memory", memory);
    print("vote, from segments", stored);
  }

  // From nothing open to the first answer.
  void start(const std::string& how, bool evict) {
    Random random(3);
    const AppearanceVector query = simulate(random, words_);
    for (const bool in_memory : {true, false}) {
      Times times;
      for (int repeat = 0; repeat < 5; ++repeat) {
        if (evict) evict_from_page_cache(file_);
        const Moment begin = now();
        DataFolder data(folder_);
        const ReadTransaction db = data.store().read();
        const MapLayout layout = load_layout(db, map_);
        if (in_memory) {
          vote(query, load_index(db, layout, vocabulary_), VoteRule::kMin, 12);
        } else {
          vote(query, SegmentPostingSource(db, layout, vocabulary_), VoteRule::kMin, 12);
        }
        times.add(begin);
      }
      print(std::string("start to first answer, ") + (in_memory ? "load index" : "segments") + ", " + how, times);
    }
  }

  void without_segments() {
    DataFolder data(folder_);
    WriteTransaction db = data.store().write();  // not committed
    drop_segments(db, map_, vocabulary_);
    Times times;
    for (int repeat = 0; repeat < 3; ++repeat) {
      const Moment begin = now();
      load_index(db, map_, vocabulary_);
      times.add(begin);
    }
    print("load index from appearances alone", times);
  }

  void check() {
    DataFolder data(folder_);
    Times times;
    const Moment begin = now();
    const StoreCheckReport report = check_store(data.store().read(), {3, {}});
    times.add(begin);
    print("check", times);
    for (const Finding& finding : report.findings) {
      std::printf("  FOUND %s: %s\n", finding.where.c_str(), finding.what.c_str());
    }
  }

  void remove() {
    DataFolder data(folder_);
    Times times;
    const Moment begin = now();
    WriteTransaction db = data.store().write();
    delete_map(db, map_);
    db.commit();
    times.add(begin);
    print("delete the map", times);
  }

  std::filesystem::path folder_;
  std::filesystem::path file_;
  std::uint32_t images_;
  ZipfWords words_;
  VocabularyId vocabulary_{};
  MapId map_{};
};

}  // namespace
}  // namespace mapweld

int main(int argc, char** argv) {
  std::vector<std::uint32_t> images = {2'000, 20'000};
  std::filesystem::path folder = std::filesystem::temp_directory_path();
  double zipf = 1.0;
  CLI::App app("What storage costs on simulated images.");
  app.add_option("--images", images, "Sizes of the maps")->delimiter(',');
  app.add_option("--folder", folder, "Where to make the databases: a folder on the disk to be measured");
  app.add_option("--zipf", zipf, "Exponent of Zipf's law");
  CLI11_PARSE(app, argc, argv);
  try {
    for (const std::uint32_t count : images) {
      const std::filesystem::path data = folder / ("mapweld-storage-benchmark-" + std::to_string(::getpid()));
      mapweld::StorageBenchmark(data, count, zipf).run();
      std::filesystem::remove_all(data);
    }
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 1;
  }
  return 0;
}
