#include "server/http/router.h"

#include <algorithm>
#include <utility>

#include "client/contract/problem.h"

namespace mapweld::server {
namespace {

std::vector<std::string> split(std::string_view path) {
  std::vector<std::string> segments;
  std::size_t begin = path.empty() || path.front() != '/' ? 0 : 1;
  while (true) {
    const std::size_t end = path.find('/', begin);
    segments.emplace_back(path.substr(begin, end - begin));
    if (end == std::string_view::npos) return segments;
    begin = end + 1;
  }
}

bool is_parameter(std::string_view segment) { return segment.size() > 2 && segment.front() == '{'; }

bool fits(const std::vector<std::string>& pattern, const std::vector<std::string>& segments,
          std::map<std::string, std::string>& parameters) {
  if (pattern.size() != segments.size()) return false;
  for (std::size_t i = 0; i < pattern.size(); ++i) {
    if (!is_parameter(pattern[i])) {
      if (pattern[i] != segments[i]) return false;
      continue;
    }
    std::string value;
    if (!percent_decode(segments[i], value) || value.empty()) return false;
    parameters[pattern[i].substr(1, pattern[i].size() - 2)] = std::move(value);
  }
  return true;
}

int hex_digit(char c) {
  if (c >= '0' && c <= '9') return c - '0';
  if (c >= 'a' && c <= 'f') return c - 'a' + 10;
  if (c >= 'A' && c <= 'F') return c - 'A' + 10;
  return -1;
}

}  // namespace

void Router::add(Route route) {
  segments_.push_back(split(route.pattern));
  routes_.push_back(std::move(route));
}

Router::Match Router::match(std::string_view method, std::string_view path) const {
  const std::string_view wanted = method == "HEAD" ? "GET" : method;
  const std::vector<std::string> segments = split(path);
  Match match;
  std::vector<std::string> allowed;
  for (std::size_t i = 0; i < routes_.size(); ++i) {
    std::map<std::string, std::string> parameters;
    if (!fits(segments_[i], segments, parameters)) continue;
    if (routes_[i].method == wanted) {
      match.route = &routes_[i];
      match.parameters = std::move(parameters);
      return match;
    }
    if (std::ranges::find(allowed, routes_[i].method) != allowed.end()) continue;
    allowed.push_back(routes_[i].method);
    if (routes_[i].method == "GET") allowed.emplace_back("HEAD");
  }
  if (!allowed.empty()) allowed.emplace_back("OPTIONS");
  for (const std::string& known : allowed) match.allow += (match.allow.empty() ? "" : ", ") + known;
  return match;
}

bool percent_decode(std::string_view encoded, std::string& decoded) {
  decoded.clear();
  decoded.reserve(encoded.size());
  for (std::size_t i = 0; i < encoded.size(); ++i) {
    if (encoded[i] != '%') {
      decoded.push_back(encoded[i]);
      continue;
    }
    if (i + 2 >= encoded.size()) return false;
    const int high = hex_digit(encoded[i + 1]);
    const int low = hex_digit(encoded[i + 2]);
    if (high < 0 || low < 0) return false;
    decoded.push_back(static_cast<char>(high * 16 + low));
    i += 2;
  }
  return true;
}

std::multimap<std::string, std::string> parse_query(std::string_view query) {
  std::multimap<std::string, std::string> values;
  while (!query.empty()) {
    const std::size_t end = std::min(query.find('&'), query.size());
    std::string pair(query.substr(0, end));
    query.remove_prefix(std::min(end + 1, query.size()));
    if (pair.empty()) continue;
    std::replace(pair.begin(), pair.end(), '+', ' ');
    const std::size_t equals = std::min(pair.find('='), pair.size());
    std::string name;
    std::string value;
    if (!percent_decode(std::string_view(pair).substr(0, equals), name) ||
        !percent_decode(std::string_view(pair).substr(std::min(equals + 1, pair.size())), value)) {
      throw contract::ContractError("malformed_request", "The query has a broken percent escape.");
    }
    values.emplace(std::move(name), std::move(value));
  }
  return values;
}

}  // namespace mapweld::server
