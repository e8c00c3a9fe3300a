#include "server/http/multipart.h"

#include <algorithm>
#include <cctype>
#include <optional>

#include "client/contract/problem.h"

namespace mapweld::server {
namespace {

using contract::ContractError;

constexpr std::size_t kMaxBoundary = 70;      // RFC 2046, section 5.1.1
constexpr std::size_t kMaxPartHeader = 4096;  // all header fields of a part

[[noreturn]] void malformed(const std::string& why) { throw ContractError("malformed_multipart", why); }

std::string lower(std::string_view text) {
  std::string out(text);
  std::transform(out.begin(), out.end(), out.begin(), [](unsigned char c) { return std::tolower(c); });
  return out;
}

std::string_view trim(std::string_view text) {
  while (!text.empty() && std::isspace(static_cast<unsigned char>(text.front()))) text.remove_prefix(1);
  while (!text.empty() && std::isspace(static_cast<unsigned char>(text.back()))) text.remove_suffix(1);
  return text;
}

// The value of parameter `name` in "type; a=b; c=\"d;e\"".
std::optional<std::string> header_parameter(std::string_view header, std::string_view name) {
  std::size_t at = header.find(';');
  while (at != std::string_view::npos) {
    header.remove_prefix(at + 1);
    const std::size_t equals = header.find_first_of("=;");
    if (equals == std::string_view::npos) return std::nullopt;
    if (header[equals] == ';') {
      at = equals;
      continue;
    }
    const bool wanted = lower(trim(header.substr(0, equals))) == name;
    header.remove_prefix(equals + 1);
    while (!header.empty() && (header.front() == ' ' || header.front() == '\t')) header.remove_prefix(1);
    std::string value;
    std::size_t end = 0;
    if (!header.empty() && header.front() == '"') {
      for (end = 1; end < header.size() && header[end] != '"'; ++end) {
        if (header[end] == '\\' && end + 1 < header.size() && (header[end + 1] == '"' || header[end + 1] == '\\'))
          ++end;
        value.push_back(header[end]);
      }
      if (end == header.size()) malformed("A part has a quoted value without an end.");
      at = header.find(';', end);
    } else {
      at = header.find(';');
      value = trim(header.substr(0, at));
    }
    if (wanted) return value;
  }
  return std::nullopt;
}

// Browsers and curl write a quote or a line end in a file name as %22, %0D, %0A (RFC 7578, section 4.2 and WHATWG).
std::string undo_percent(std::string name) {
  for (const auto& [escape, character] : {std::pair{"%22", '"'}, std::pair{"%0D", '\r'}, std::pair{"%0A", '\n'}}) {
    for (std::size_t at = name.find(escape); at != std::string::npos; at = name.find(escape, at + 1)) {
      name.replace(at, 3, 1, character);
    }
  }
  return name;
}

Part parse_part(std::string_view bytes) {
  const std::size_t end = bytes.starts_with("\r\n") ? 0 : bytes.substr(0, kMaxPartHeader + 4).find("\r\n\r\n");
  if (end == std::string_view::npos) malformed("A part has no end of its header fields.");
  std::string_view fields = bytes.substr(0, end);
  Part part;
  part.content = bytes.substr(end + (end == 0 ? 2 : 4));
  while (!fields.empty()) {
    const std::string_view line = fields.substr(0, fields.find("\r\n"));
    fields.remove_prefix(std::min(line.size() + 2, fields.size()));
    const std::size_t colon = line.find(':');
    if (colon == std::string_view::npos) malformed("A part has a header field without a colon.");
    const std::string field = lower(trim(line.substr(0, colon)));
    if (field == "content-transfer-encoding" && lower(trim(line.substr(colon + 1))) != "binary") {
      malformed("A part is transfer-encoded; send the bytes of the image as they are.");
    }
    if (field != "content-disposition") continue;
    const std::string_view value = line.substr(colon + 1);
    if (lower(trim(value.substr(0, value.find(';')))) != "form-data") malformed("A part is not form-data.");
    part.name = header_parameter(value, "name").value_or("");
    part.file_name = undo_percent(header_parameter(value, "filename").value_or(""));
  }
  return part;
}

struct Delimiter {
  std::size_t begin = 0;  // of the line end before it
  std::size_t end = 0;    // after its own line end
  bool closes = false;    // the last one: "--" follows
};

// What follows a boundary that ends at `at`: "--", or perhaps spaces and a line end; nullopt when neither: then the
// boundary is only part of a longer line.
std::optional<Delimiter> end_of_delimiter(std::string_view body, std::size_t at) {
  const std::string_view rest = body.substr(at);
  if (rest.starts_with("--")) return Delimiter{0, at + 2, true};
  const std::size_t padding = std::min(rest.find_first_not_of(" \t"), rest.size());
  if (!rest.substr(padding).starts_with("\r\n")) return std::nullopt;
  return Delimiter{0, at + padding + 2, false};
}

std::optional<Delimiter> find_delimiter(std::string_view body, std::size_t from, std::string_view delimiter) {
  for (std::size_t at = body.find(delimiter, from); at != std::string_view::npos; at = body.find(delimiter, at + 1)) {
    if (auto found = end_of_delimiter(body, at + delimiter.size())) {
      found->begin = at;
      return found;
    }
  }
  return std::nullopt;
}

}  // namespace

std::string multipart_boundary(std::string_view content_type) {
  if (lower(trim(content_type.substr(0, content_type.find(';')))) != "multipart/form-data") {
    throw ContractError("unsupported_media_type", "A batch is sent as multipart/form-data, one part an image.");
  }
  std::optional<std::string> boundary = header_parameter(content_type, "boundary");
  if (!boundary || boundary->empty() || boundary->size() > kMaxBoundary) {
    malformed("The Content-Type has no boundary of 1 to " + std::to_string(kMaxBoundary) + " characters.");
  }
  return *boundary;
}

std::vector<Part> parse_multipart(std::string_view body, std::string_view boundary, std::size_t max_parts) {
  const std::string delimiter = "\r\n--" + std::string(boundary);
  std::vector<Part> parts;
  // The first delimiter may stand at the very beginning, without the line end that belongs to the others.
  std::optional<Delimiter> here = body.starts_with(std::string_view(delimiter).substr(2))
                                      ? end_of_delimiter(body, delimiter.size() - 2)
                                      : std::nullopt;
  if (!here) here = find_delimiter(body, 0, delimiter);
  if (!here) malformed("The boundary does not occur in the body.");
  while (!here->closes) {
    if (parts.size() == max_parts) {
      throw ContractError("too_many_images", "A batch has at most " + std::to_string(max_parts) + " parts.");
    }
    const std::optional<Delimiter> next = find_delimiter(body, here->end, delimiter);
    if (!next) malformed("The body breaks off before its closing boundary.");
    parts.push_back(parse_part(body.substr(here->end, next->begin - here->end)));
    here = next;
  }
  return parts;
}

}  // namespace mapweld::server
