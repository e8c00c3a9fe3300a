#include "client/command/terminal.h"

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <csignal>
#include <cstdlib>
#include <system_error>

#include <sys/ioctl.h>
#include <unistd.h>

namespace mapweld::command {
namespace {

bool is_continuation(char c) { return (static_cast<unsigned char>(c) & 0xC0U) == 0x80; }

std::string formatted(const char* format, double number) {
  char text[64];
  std::snprintf(text, sizeof text, format, number);
  return text;
}

std::string padded(std::string_view text, std::size_t columns, bool right) {
  const std::size_t width = columns_of(text);
  const std::string space(columns > width ? columns - width : 0, ' ');
  return right ? space + std::string(text) : std::string(text) + space;
}

}  // namespace

bool is_terminal(std::FILE* stream) { return isatty(fileno(stream)) == 1; }

int terminal_columns(std::FILE* stream) {
  winsize size{};
  return ioctl(fileno(stream), TIOCGWINSZ, &size) == 0 && size.ws_col > 0 ? size.ws_col : 80;
}

bool speaks_utf8() {
  for (const char* name : {"LC_ALL", "LC_CTYPE", "LANG"}) {
    const char* value = std::getenv(name);
    if (value == nullptr || *value == '\0') continue;
    const std::string_view locale = value;
    for (const char* utf8 : {"UTF-8", "utf-8", "UTF8", "utf8"}) {
      if (locale.find(utf8) != std::string_view::npos) return true;
    }
    return false;
  }
  return false;
}

std::size_t columns_of(std::string_view text) {
  return static_cast<std::size_t>(std::count_if(text.begin(), text.end(), [](char c) { return !is_continuation(c); }));
}

std::string cut_to(std::string_view text, std::size_t columns) {
  if (columns_of(text) <= columns) return std::string(text);
  const std::string_view ellipsis = speaks_utf8() ? "…" : ".";
  std::size_t end = 0;
  for (std::size_t seen = 0; end < text.size(); ++end) {
    if (is_continuation(text[end])) continue;
    if (seen + 1 >= columns) break;
    ++seen;
  }
  return std::string(text.substr(0, end)) + std::string(columns > 0 ? ellipsis : "");
}

std::string printable(std::string_view text) {
  std::string shown;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const auto byte = static_cast<unsigned char>(text[i]);
    const bool c1 = byte == 0xC2 && i + 1 < text.size() && static_cast<unsigned char>(text[i + 1]) < 0xA0;
    if (byte < 0x20 || byte == 0x7F || c1) {
      shown += '?';
      if (c1) ++i;
    } else {
      shown += text[i];
    }
  }
  return shown;
}

std::string duration_text(double seconds) {
  if (seconds < 10) return formatted("%.2f s", seconds);
  if (seconds < 99.95) return formatted("%.1f s", seconds);
  const auto whole = static_cast<long long>(std::llround(std::min(seconds, 1e15)));
  if (whole < 3600) return std::to_string(whole / 60) + " min " + std::to_string(whole % 60) + " s";
  return std::to_string(whole / 3600) + " h " + std::to_string(whole / 60 % 60) + " min";
}

std::string time_text(const std::string& rfc3339) {
  const auto dot = rfc3339.find('.');
  if (dot == std::string::npos) return rfc3339;
  const auto end = rfc3339.find_first_not_of("0123456789", dot + 1);
  return rfc3339.substr(0, dot) + (end == std::string::npos ? "" : rfc3339.substr(end));
}

std::string number_text(double number) { return number == 0 ? "0" : formatted("%.4g", number); }

std::string bytes_text(std::uint64_t bytes) {
  constexpr const char* kUnits[] = {"KB", "MB", "GB", "TB"};
  if (bytes < 1000) return count_text(static_cast<std::int64_t>(bytes), "byte");
  double amount = static_cast<double>(bytes) / 1000;
  std::size_t unit = 0;
  for (; amount >= 999.5 && unit < 3; ++unit) amount /= 1000;
  return formatted(amount < 10 ? "%.1f" : "%.0f", amount) + " " + kUnits[unit];
}

std::string count_text(std::int64_t count, std::string_view one, std::string_view many) {
  const std::string plural = many.empty() ? std::string(one) + "s" : std::string(many);
  return std::to_string(count) + " " + (count == 1 ? std::string(one) : plural);
}

std::string edge_counts_text(const contract::EdgeCounts& counts) {
  if (counts.verified == 0) return "none verified";
  const std::string confirmed = std::to_string(counts.confirmed) + " confirmed, ";
  if (counts.confirmed == counts.verified) return confirmed + "all that were verified";
  return confirmed + "of " + std::to_string(counts.verified) + " verified";
}

std::string bar(double fraction, int columns) {
  const bool utf8 = speaks_utf8();
  const int full = static_cast<int>(std::floor(std::clamp(fraction, 0.0, 1.0) * columns));
  std::string text = "[";
  for (int i = 0; i < columns; ++i) text += i < full ? (utf8 ? "█" : "#") : (utf8 ? "░" : ".");
  return text + "]";
}

std::string sparkline(const std::vector<double>& values, int columns) {
  constexpr const char* kBlocks[] = {"▁", "▂", "▃", "▄", "▅", "▆", "▇", "█"};
  constexpr const char* kAscii[] = {"_", ".", "-", "~", "=", "+", "*", "#"};
  if (values.empty() || columns < 1) return "";
  const bool utf8 = speaks_utf8();
  const double most = *std::max_element(values.begin(), values.end());
  const std::size_t shown = std::min(values.size(), static_cast<std::size_t>(columns));
  std::string text;
  for (std::size_t i = 0; i < shown; ++i) {
    const double value = values[(i + 1) * values.size() / shown - 1];
    const int level = most > 0 ? std::clamp(static_cast<int>(value / most * 7.999), 0, 7) : 0;
    text += utf8 ? kBlocks[level] : kAscii[level];
  }
  return text;
}

Table::Table(std::vector<std::string> headings, std::vector<std::size_t> right) : right_(headings.size(), false) {
  for (const std::size_t column : right) right_.at(column) = true;
  rows_.push_back(std::move(headings));
}

void Table::add(std::vector<std::string> row) { rows_.push_back(std::move(row)); }

std::string Table::text() const {
  std::vector<std::size_t> widths(right_.size(), 0);
  for (const auto& row : rows_) {
    const std::size_t own = row.size() < right_.size() ? row.size() - 1 : row.size();
    for (std::size_t i = 0; i < own; ++i) widths[i] = std::max(widths[i], columns_of(row[i]));
  }
  std::string text;
  for (const auto& row : rows_) {
    std::string line;
    for (std::size_t i = 0; i < row.size(); ++i) {
      line += (i == 0 ? "" : "  ") + padded(row[i], widths[i], right_[i] && row.size() == right_.size());
    }
    line.erase(line.find_last_not_of(' ') + 1);
    text += line + "\n";
  }
  return text;
}

std::string facts(const std::vector<std::pair<std::string, std::string>>& lines) {
  std::size_t width = 0;
  for (const auto& [name, value] : lines) width = std::max(width, columns_of(name));
  std::string text;
  for (const auto& [name, value] : lines) text += padded(name, width, false) + "  " + value + "\n";
  return text;
}

void Panel::draw(const std::vector<std::string>& lines) {
  std::string text = drawn_ > 0 ? "\x1b[" + std::to_string(drawn_) + "F" : "";
  const auto columns = static_cast<std::size_t>(terminal_columns(stream_));
  for (const std::string& line : lines) text += "\x1b[2K" + cut_to(line, columns - 1) + "\n";
  text += "\x1b[J";
  drawn_ = lines.size();
  std::fwrite(text.data(), 1, text.size(), stream_);
  std::fflush(stream_);
}

void Panel::clear() {
  if (drawn_ == 0) return;
  std::fprintf(stream_, "\x1b[%zuF\x1b[J", drawn_);
  std::fflush(stream_);
  drawn_ = 0;
}

void print(std::string_view text) {
  if (std::fwrite(text.data(), 1, text.size(), stdout) != text.size() || std::fflush(stdout) != 0) {
    if (errno == EPIPE) std::_Exit(128 + SIGPIPE);  // while a request has the signal blocked
    throw std::system_error(errno, std::generic_category(), "Cannot write to standard output");
  }
}

void print_json(const contract::Json& json) { print(contract::dump(json) + "\n"); }

}  // namespace mapweld::command
