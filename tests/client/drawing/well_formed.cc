#include "tests/client/drawing/well_formed.h"

#include <cctype>
#include <regex>
#include <set>
#include <vector>

namespace mapweld::testing {
namespace {

bool entities_are_known(std::string_view text) {
  for (std::size_t i = text.find('&'); i != std::string_view::npos; i = text.find('&', i + 1)) {
    const std::string_view rest = text.substr(i);
    bool known = false;
    for (const char* entity : {"&amp;", "&lt;", "&gt;", "&quot;", "&apos;"}) known = known || rest.starts_with(entity);
    if (!known) return false;
  }
  return true;
}

// "what: text"
std::string fault(const char* what, const std::string& text) { return std::string(what).append(": ").append(text); }

// std::regex recurses once a character: embedded pictures are taken out of a tag, after a look at their letters.
std::string without_pictures(std::string tag) {
  constexpr std::string_view kBegin = "base64,";
  for (std::size_t at = tag.find(kBegin); at != std::string::npos; at = tag.find(kBegin, at)) {
    at += kBegin.size();
    const std::size_t end =
        tag.find_first_not_of("ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/=\n", at);
    tag.erase(at, end == std::string::npos ? end : end - at);
  }
  return tag;
}

}  // namespace

std::string xml_fault(std::string_view text) {
  static const std::regex kTag(R"re(([A-Za-z][\w:-]*)((\s+[A-Za-z][\w:-]*="[^"<]*")*)\s*(/?))re");
  static const std::regex kAttribute(R"re(([A-Za-z][\w:-]*)=")re");
  std::vector<std::string> open;
  std::size_t roots = 0;
  std::size_t at = 0;
  if (text.starts_with("<?xml ")) at = text.find("?>") + 2;
  while (at < text.size()) {
    const std::size_t tag = text.find('<', at);
    const std::string_view data = text.substr(at, tag == std::string_view::npos ? tag : tag - at);
    if (!entities_are_known(data)) return "unknown entity before byte " + std::to_string(tag);
    if (open.empty() && data.find_first_not_of(" \n\t\r") != std::string_view::npos) return "text outside the root";
    if (tag == std::string_view::npos) break;
    const std::size_t end = text.find('>', tag);
    if (end == std::string_view::npos) return "a tag that does not end at byte " + std::to_string(tag);
    const std::string inside = without_pictures(std::string(text.substr(tag + 1, end - tag - 1)));
    if (inside.starts_with("/")) {
      if (open.empty() || open.back() != inside.substr(1)) return fault("an end tag that closes nothing", inside);
      open.pop_back();
    } else {
      std::smatch match;
      if (!std::regex_match(inside, match, kTag)) return fault("not a tag", inside);
      const std::string attributes = match[2];
      if (!entities_are_known(attributes)) return fault("unknown entity", inside);
      std::set<std::string> names;
      for (std::sregex_iterator i(attributes.begin(), attributes.end(), kAttribute), none; i != none; ++i) {
        if (!names.insert((*i)[1]).second) return fault("attribute twice", inside);
      }
      if (open.empty() && ++roots > 1) return "a second root";
      if (match[4].length() == 0) open.push_back(match[1]);
    }
    at = end + 1;
  }
  for (const char c : text) {
    if (static_cast<unsigned char>(c) < 0x20 && c != '\n' && c != '\t' && c != '\r') return "a control character";
  }
  if (!open.empty()) return fault("not closed", open.back());
  return roots == 1 ? "" : "no root";
}

std::size_t count_elements(std::string_view text, std::string_view name) {
  const std::string begin = std::string("<").append(name);
  std::size_t count = 0;
  for (std::size_t i = text.find(begin); i != std::string_view::npos; i = text.find(begin, i + 1)) {
    const char after = text[i + begin.size()];
    if (after == ' ' || after == '>' || after == '/') ++count;
  }
  return count;
}

std::string_view element_of_class(std::string_view text, std::string_view class_name) {
  const std::size_t begin = text.find("<g class=\"" + std::string(class_name) + "\"");
  if (begin == std::string_view::npos) return "";
  return text.substr(begin, text.find("</g>", begin) - begin);
}

}  // namespace mapweld::testing
