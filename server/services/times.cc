#include "server/services/times.h"

#include <charconv>
#include <chrono>
#include <cstdio>

namespace mapweld::server {
namespace {

using std::chrono::days;
using std::chrono::hours;
using std::chrono::microseconds;
using std::chrono::minutes;
using std::chrono::seconds;

// Reads text piece by piece; `ok` turns false at the first piece that does not fit.
struct Scanner {
  std::string_view rest;
  bool ok = true;

  int number(std::size_t digits, int least, int most) {
    int value = 0;
    ok = ok && rest.size() >= digits;
    for (std::size_t i = 0; ok && i < digits; ++i) {
      ok = rest[i] >= '0' && rest[i] <= '9';
      value = value * 10 + (rest[i] - '0');
    }
    if (ok) rest.remove_prefix(digits);
    ok = ok && value >= least && value <= most;
    return value;
  }
  void character(std::string_view allowed) {
    ok = ok && !rest.empty() && allowed.find(rest.front()) != std::string_view::npos;
    if (ok) rest.remove_prefix(1);
  }
};

}  // namespace

Timestamp now() { return std::chrono::floor<microseconds>(std::chrono::system_clock::now()); }

std::string to_rfc3339(Timestamp time) {
  const auto day = std::chrono::floor<days>(time);
  const std::chrono::year_month_day date(day);
  const std::chrono::hh_mm_ss clock(time - day);
  char text[64];
  std::snprintf(text, sizeof(text), "%04d-%02u-%02uT%02d:%02d:%02d", static_cast<int>(date.year()),
                static_cast<unsigned>(date.month()), static_cast<unsigned>(date.day()),
                static_cast<int>(clock.hours().count()), static_cast<int>(clock.minutes().count()),
                static_cast<int>(clock.seconds().count()));
  std::string out = text;
  if (const auto fraction = clock.subseconds().count(); fraction != 0) {
    std::snprintf(text, sizeof(text), ".%06d", static_cast<int>(fraction));
    out += text;
    out.erase(out.find_last_not_of('0') + 1);
  }
  return out + "Z";
}

std::optional<Timestamp> parse_rfc3339(std::string_view text) {
  Scanner scan{text};
  const int year = scan.number(4, 0, 9999);
  scan.character("-");
  const int month = scan.number(2, 1, 12);
  scan.character("-");
  const int day = scan.number(2, 1, 31);
  scan.character("Tt ");
  const int hour = scan.number(2, 0, 23);
  scan.character(":");
  const int minute = scan.number(2, 0, 59);
  scan.character(":");
  const int second = scan.number(2, 0, 60);  // 60: a leap second, taken as the one that follows
  std::int64_t fraction_us = 0;
  if (scan.ok && scan.rest.starts_with('.')) {
    scan.character(".");
    std::int64_t unit_us = 100'000;
    scan.ok = !scan.rest.empty() && scan.rest.front() >= '0' && scan.rest.front() <= '9';
    while (scan.ok && !scan.rest.empty() && scan.rest.front() >= '0' && scan.rest.front() <= '9') {
      fraction_us += unit_us * scan.number(1, 0, 9);
      unit_us /= 10;
    }
  }
  minutes offset{0};
  if (scan.ok && (scan.rest == "Z" || scan.rest == "z")) {
    scan.rest = {};
  } else {
    const bool west = scan.rest.starts_with('-');
    scan.character("+-");
    const int offset_hours = scan.number(2, 0, 23);
    scan.character(":");
    offset = hours(offset_hours) + minutes(scan.number(2, 0, 59));
    if (west) offset = -offset;
  }
  const std::chrono::year_month_day date{std::chrono::year(year), std::chrono::month(static_cast<unsigned>(month)),
                                         std::chrono::day(static_cast<unsigned>(day))};
  if (!scan.ok || !scan.rest.empty() || !date.ok()) return std::nullopt;
  return Timestamp(std::chrono::sys_days(date)) + hours(hour) + minutes(minute) + seconds(second) - offset +
         microseconds(fraction_us);
}

}  // namespace mapweld::server
