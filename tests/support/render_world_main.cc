// render-sample-world: writes two robots' images of a made-up building, queries, and the truth about them.
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <stdexcept>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>

#include "tests/support/rendering/parallel.h"
#include "tests/support/sample_maps.h"

namespace {

using mapweld::rendered::SampleMap;
using mapweld::rendered::SampleMaps;
namespace fs = std::filesystem;

std::string file_name(std::size_t index) {
  char name[32];
  std::snprintf(name, sizeof name, "%06zu.jpg", index);
  return name;
}

void write_file(const fs::path& path, const void* bytes, std::size_t size) {
  std::ofstream file(path, std::ios::binary);
  file.write(static_cast<const char*>(bytes), static_cast<std::streamsize>(size));
  file.close();
  if (!file) throw std::runtime_error("cannot write " + path.string());
}

void write_images(const fs::path& folder, const SampleMap& map) {
  fs::create_directories(folder);
  for (std::size_t i = 0; i < map.size(); ++i) {
    write_file(folder / file_name(i), map.jpegs[i].data(), map.jpegs[i].size());
  }
}

std::string poses_csv(const SampleMaps& maps) {
  std::string csv = "robot,name,x_m,y_m,heading_deg,floor\n";
  const auto add = [&](const char* robot, const SampleMap& map) {
    for (std::size_t i = 0; i < map.size(); ++i) {
      const auto& pose = map.poses[i];
      char line[160];
      std::snprintf(line, sizeof line, "%s,%s,%.3f,%.3f,%.2f,%d\n", robot, file_name(i).c_str(), pose.x_m, pose.y_m,
                    pose.heading_deg, pose.storey);
      csv += line;
    }
  };
  add("robot-a", maps.a);
  add("robot-b", maps.b);
  add("queries", maps.queries);
  return csv;
}

void add_shared(std::string& csv, const SampleMap& a, const SampleMap& b, const char* robot, int threads) {
  for (const auto& pair : mapweld::rendered::shared_pairs(a.views, b.views, 0.05, threads)) {
    char line[96];
    std::snprintf(line, sizeof line, "%s,%s%s%s,%.3f\n", file_name(static_cast<std::size_t>(pair.a)).c_str(), robot,
                  *robot ? "," : "", file_name(static_cast<std::size_t>(pair.b)).c_str(), pair.shared);
    csv += line;
  }
}

int run(int argc, char** argv) {
  CLI::App app{"Renders two robots' drives through a made-up building, with ground truth.", "render-sample-world"};
  std::string out;
  mapweld::rendered::SampleMapsOptions options;
  options.n_images_a = 150;
  options.n_images_b = 100;
  options.n_queries = 20;
  options.threads = 2;
  app.add_option("--out", out, "folder to write to, made if missing")->required();
  app.add_option("--images-a", options.n_images_a, "images of the first robot")->check(CLI::Range(1, 20000));
  app.add_option("--images-b", options.n_images_b, "images of the second robot")->check(CLI::Range(1, 20000));
  app.add_option("--queries", options.n_queries, "images in neither map")->check(CLI::Range(0, 20000));
  app.add_option("--seed", options.seed, "another building, another drive");
  app.add_option("--threads", options.threads, "threads; the images do not depend on it")->check(CLI::Range(1, 256));
  app.add_flag("--look-alike", options.look_alike, "corridors that look alike");
  app.get_formatter()->column_width(32);
  for (CLI::Option* option : app.get_options()) option->capture_default_str();
  CLI11_PARSE(app, argc, argv);

  const fs::path folder(out);
  const SampleMaps maps = mapweld::rendered::render_sample_maps(options);
  write_images(folder / "robot-a", maps.a);
  write_images(folder / "robot-b", maps.b);
  write_images(folder / "queries", maps.queries);
  const auto write_text = [&](const char* name, const std::string& text) {
    write_file(folder / name, text.data(), text.size());
  };
  write_text("poses.csv", poses_csv(maps));
  std::string visible = "query,robot,name,shared\n";
  add_shared(visible, maps.queries, maps.a, "robot-a", options.threads);
  add_shared(visible, maps.queries, maps.b, "robot-b", options.threads);
  write_text("visible.csv", visible);
  std::string pairs = "a,b,shared\n";
  add_shared(pairs, maps.a, maps.b, "", options.threads);
  write_text("pairs.csv", pairs);
  std::cout << maps.a.size() << " + " << maps.b.size() << " images and " << maps.queries.size() << " queries in " << out
            << "\n";
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  try {
    return run(argc, argv);
  } catch (const std::exception& error) {
    std::cerr << "render-sample-world: " << error.what() << "\n";
    return 1;
  }
}
