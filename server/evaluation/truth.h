// What is known about which images of two maps show the same place.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>
#include <unordered_map>
#include <vector>

namespace mapweld::server::evaluation {

struct TruthOptions {
  double min_shared = 0.1;    // pairs.csv with a column `shared`: a pair is right when it shares at least so much
  double max_distance_m = 3;  // poses.csv: a pair is right when taken on one floor, at most so far apart
  double max_turn_deg = 45;   // and turned at most so far
};

// A truth file that cannot be understood.
class TruthError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

// The images of a map as the truth names them.
struct NamedMap {
  std::string name;
  std::vector<std::string> images;  // by vertex
};

class Truth {
 public:
  Truth() = default;

  bool is_right(std::uint32_t a, std::uint32_t b) const { return right_.contains(key(a, b)); }
  // Listed in the file, be it below `min_shared`: neither right nor wholly wrong. Poses: as is_right.
  bool is_listed(std::uint32_t a, std::uint32_t b) const { return is_right(a, b) || listed_.contains(key(a, b)); }
  std::uint64_t right_pairs() const { return right_.size(); }
  // By vertex of the second map: whether some image of the first shows its place; graded truth: shares `min_shared` or
  // more with it.
  std::vector<bool> placed_in_second(std::uint32_t vertices, double min_shared = 0) const;
  std::uint64_t lines() const { return lines_; }
  std::uint64_t unknown_lines() const { return unknown_lines_; }  // naming an image that is no vertex
  bool is_graded() const { return is_graded_; }                   // pairs with the share of their view
  bool is_complete() const { return is_complete_; }  // what is not listed is known to be wrong: graded, or poses
  const std::string& rule() const { return rule_; }  // what "right" means, in words

  // A CSV file with a header. `a,b[,shared]`: pairs of image names. With columns of any other name the first two are
  // taken, in the order, a b or b a, in which more lines name vertices of both maps.
  // `robot,name,x_m,y_m,heading_deg,floor`: poses; `robot` is the map's name, or else the first two robots of the file
  // are the two maps. Names are compared whole. Throws TruthError.
  static Truth parse(std::string_view csv, const std::array<NamedMap, 2>& maps, const TruthOptions& options = {});

 private:
  static std::uint64_t key(std::uint32_t a, std::uint32_t b) { return (std::uint64_t{a} << 32) | b; }
  std::unordered_map<std::uint64_t, double> right_;   // with what they share; 1 where the truth is not graded
  std::unordered_map<std::uint64_t, double> listed_;  // and are not right
  std::uint64_t lines_ = 0;
  std::uint64_t unknown_lines_ = 0;
  bool is_graded_ = false;
  bool is_complete_ = false;
  std::string rule_;

  friend class TruthReader;
};

}  // namespace mapweld::server::evaluation
