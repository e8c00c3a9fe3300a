// What the core throws when a request is broken. Expected outcomes (rejected, ignored, nothing found) are values.
#pragma once

#include <stdexcept>
#include <string>
#include <utility>

namespace mapweld {

// A request that cannot be served; `code` is the stable word of http-api.md.
class CodedError : public std::runtime_error {
 public:
  CodedError(std::string code, const std::string& detail) : std::runtime_error(detail), code_(std::move(code)) {}
  const std::string& code() const { return code_; }

 private:
  std::string code_;
};

// Bytes that cannot become a grey image: "unsupported_image" (neither JPEG nor PNG), "image_too_large",
// "undecodable_image" (truncated, corrupt), "empty_body".
class ImageError : public CodedError {
  using CodedError::CodedError;
};

// Bytes or parameters that break a format or an invariant (vocabulary files, checkpoints, option values).
class FormatError : public std::runtime_error {
  using std::runtime_error::runtime_error;
};

}  // namespace mapweld
