// Text for people: tables, bars, panels that are redrawn, numbers in words.
#pragma once

#include <cstdint>
#include <cstdio>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "client/contract/edge_counts.h"
#include "client/contract/json.h"

namespace mapweld::command {

bool is_terminal(std::FILE* stream);
int terminal_columns(std::FILE* stream);  // 80 when unknown
bool speaks_utf8();                       // by LC_ALL, LC_CTYPE, LANG

// How many columns a UTF-8 text takes (one a code point; the command prints no wide characters of its own).
std::size_t columns_of(std::string_view text);
// At most so many columns, the last an ellipsis when something was cut.
std::string cut_to(std::string_view text, std::size_t columns);

// Text from the server or the file system with its control characters made visible, so that it cannot drive a terminal.
std::string printable(std::string_view text);

// "0.25 s", "12.5 s", "2 min 5 s", "1 h 2 min".
std::string duration_text(double seconds);
// An RFC 3339 time without its fraction of a second: "2026-11-23T10:00:00Z".
std::string time_text(const std::string& rfc3339);
// Four significant digits: "0.01310", "12.35", "3.2e-05"; "0" for exactly 0.
std::string number_text(double number);
// "812 bytes", "56 KB", "1.2 GB".
std::string bytes_text(std::uint64_t bytes);
// "1 edge", "2 edges".
std::string count_text(std::int64_t count, std::string_view one, std::string_view many = "");

// "609 confirmed, of 1511 verified"; "1511 confirmed, all that were verified".
std::string edge_counts_text(const contract::EdgeCounts& counts);

// [██████░░░░]
std::string bar(double fraction, int columns);
// ▁▂▄▇ : `values` resampled to at most `columns`, from 0 to their maximum.
std::string sparkline(const std::vector<double>& values, int columns);

// Columns under headings; the columns in `right` (by index) are aligned to the right. The last cell of a row that has
// fewer cells than there are headings runs on to the end of the line.
class Table {
 public:
  Table(std::vector<std::string> headings, std::vector<std::size_t> right);
  void add(std::vector<std::string> row);
  std::string text() const;

 private:
  std::vector<std::vector<std::string>> rows_;
  std::vector<bool> right_;
};

// "name  value" lines with the values aligned.
std::string facts(const std::vector<std::pair<std::string, std::string>>& lines);

// Lines that are drawn over those drawn before. For terminals only.
class Panel {
 public:
  explicit Panel(std::FILE* stream) : stream_(stream) {}
  void draw(const std::vector<std::string>& lines);
  void clear();  // as if nothing had been drawn

 private:
  std::FILE* stream_;
  std::size_t drawn_ = 0;
};

// To standard output. Throws std::system_error when it cannot be written (a full disk; a closed pipe ends the program,
// silently, as SIGPIPE does).
void print(std::string_view text);
void print_json(const contract::Json& json);  // one line

}  // namespace mapweld::command
