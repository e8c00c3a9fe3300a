// multipart/form-data (RFC 7578) of a batch upload, parsed in place: parts in their order, nothing copied.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace mapweld::server {

struct Part {
  std::string name;          // of the form field
  std::string file_name;     // empty when the part has none
  std::string_view content;  // points into the body
};

// The boundary named by a Content-Type of multipart/form-data.
// Throws ContractError: unsupported_media_type for another type, malformed_multipart without a usable boundary.
std::string multipart_boundary(std::string_view content_type);

// Splits `body`, which must outlive the parts. Takes file names in UTF-8, quoted with backslash or percent escapes for
// quotes and line ends (as browsers and curl write them). A name is a name: slashes in it mean nothing.
// Throws ContractError malformed_multipart; too_many_images for more than `max_parts`.
std::vector<Part> parse_multipart(std::string_view body, std::string_view boundary, std::size_t max_parts);

}  // namespace mapweld::server
