// What goes wrong, in one place: every code of the contract with its HTTP status and title, and the exception that
// carries one. The document that answers it is in problem_document.h.
#pragma once

#include <array>
#include <stdexcept>
#include <string>
#include <string_view>

namespace mapweld::contract {

struct CodeEntry {
  std::string_view code;   // stable word, for programs
  int status;              // HTTP status
  std::string_view title;  // for people; the same for every occurrence
};

// The one table of codes. The server answers with no other; docs/http-api.md lists it.
inline constexpr std::array kCodes = {
    CodeEntry{"malformed_json", 400, "The body is not a JSON document of the expected form"},
    CodeEntry{"malformed_multipart", 400, "The body is not multipart/form-data of the expected form"},
    CodeEntry{"malformed_request", 400, "The request is not well-formed HTTP"},
    CodeEntry{"unknown_field", 400, "The request has a field that does not exist"},
    CodeEntry{"empty_body", 400, "The body is empty"},
    CodeEntry{"invalid_name", 400, "The name is not allowed"},

    CodeEntry{"unauthorized", 401, "The server asks for a key"},
    CodeEntry{"forbidden", 403, "The key, or the page, may not do this"},
    CodeEntry{"read_only", 403, "The server changes nothing"},

    CodeEntry{"no_such_path", 404, "There is nothing under this path"},
    CodeEntry{"no_such_map", 404, "There is no map of this name"},
    CodeEntry{"no_such_vertex", 404, "The map has no such vertex"},
    CodeEntry{"no_such_image", 404, "There is no such image"},
    CodeEntry{"no_such_mask", 404, "The map has no mask"},
    CodeEntry{"no_such_vocabulary", 404, "There is no vocabulary of this name"},
    CodeEntry{"no_such_merge", 404, "There is no merge of this number"},
    CodeEntry{"no_such_backup", 404, "There is no backup of this number"},
    CodeEntry{"no_route", 404, "The map has no route between these vertices"},
    CodeEntry{"method_not_allowed", 405, "The path does not know this method"},

    CodeEntry{"request_timeout", 408, "The request did not arrive in time"},

    CodeEntry{"name_taken", 409, "The name is taken"},
    CodeEntry{"wrong_map", 409, "The map is another one than expected"},
    CodeEntry{"map_in_use", 409, "A merge uses the map"},
    CodeEntry{"map_is_merged", 409, "The map is a merged map"},
    CodeEntry{"vocabulary_in_use", 409, "Maps are made with the vocabulary"},
    CodeEntry{"vocabulary_mismatch", 409, "The maps have different vocabularies"},
    CodeEntry{"wrong_state", 409, "It is in a state that does not allow this"},
    CodeEntry{"nothing_to_resume", 409, "The merge is complete and no member has grown"},
    CodeEntry{"idempotency_in_progress", 409, "A request with this key is still under way"},

    CodeEntry{"length_required", 411, "The request does not say how long its body is"},
    CodeEntry{"body_too_large", 413, "The body is too large"},
    CodeEntry{"image_too_large", 413, "The image is too large"},
    CodeEntry{"too_many_images", 413, "The batch has too many images"},
    CodeEntry{"uri_too_long", 414, "The path or query is too long"},
    CodeEntry{"unsupported_image", 415, "The bytes are neither a JPEG nor a PNG image"},
    CodeEntry{"unsupported_media_type", 415, "The media type of the body is not supported"},
    CodeEntry{"range_not_satisfiable", 416, "The range is not satisfiable"},

    CodeEntry{"unknown_host", 421, "The server does not have this name"},

    CodeEntry{"undecodable_image", 422, "The image is truncated or corrupt"},
    CodeEntry{"empty_mask", 422, "The mask leaves no pixel"},
    CodeEntry{"duplicate_member", 422, "A map is named twice"},
    CodeEntry{"too_few_members", 422, "A merge needs two maps or more"},
    CodeEntry{"unknown_method", 422, "There is no merge method of this name"},
    CodeEntry{"invalid_budget", 422, "The budget is not valid"},
    CodeEntry{"invalid_parameter", 422, "A field or parameter has an invalid value"},
    CodeEntry{"immutable_parameter", 422, "The parameter cannot be changed any more"},
    CodeEntry{"invalid_vocabulary", 422, "The bytes are not a vocabulary"},
    CodeEntry{"damaged_file", 422, "The file is damaged, or is not what it should be"},
    CodeEntry{"idempotency_mismatch", 422, "The key was sent with another request"},

    CodeEntry{"rate_limited", 429, "Too many requests in too short a time"},
    CodeEntry{"quota_exceeded", 429, "The key has used up what it may use"},
    CodeEntry{"headers_too_large", 431, "The header block is too large"},
    CodeEntry{"internal_error", 500, "The server failed"},
    CodeEntry{"not_implemented", 501, "The server does not offer this yet"},
    CodeEntry{"shutting_down", 503, "The server is shutting down"},
    CodeEntry{"not_ready", 503, "The server is not ready yet"},
    CodeEntry{"busy", 503, "The server is busy"},
    CodeEntry{"no_space", 507, "The server has no space left"},
};

// A code of the table. From a literal it is checked by the compiler: a word that the table lacks does not build.
class Code {
 public:
  consteval Code(const char* word) : entry_(&entry_of(word)) {}  // NOLINT(google-explicit-constructor)

  // For words that come from elsewhere (the core's ImageError). A word that the table lacks is internal_error.
  static Code find(std::string_view word);

  constexpr std::string_view word() const { return entry_->code; }
  constexpr int status() const { return entry_->status; }
  constexpr std::string_view title() const { return entry_->title; }
  friend constexpr bool operator==(Code, Code) = default;

 private:
  explicit Code(const CodeEntry& entry) : entry_(&entry) {}
  static consteval const CodeEntry& entry_of(std::string_view word) {
    for (const CodeEntry& entry : kCodes) {
      if (entry.code == word) return entry;
    }
    throw "no such code";
  }
  const CodeEntry* entry_;
};

// A request that is broken or cannot be met. The server answers it with `problem_of` (problem_document.h).
class ContractError : public std::runtime_error {
 public:
  // `detail`: one or two sentences for a person who can act on them.
  ContractError(Code code, const std::string& detail) : std::runtime_error(detail), code_(code) {}
  Code code() const { return code_; }
  int status() const { return code_.status(); }
  std::string detail() const { return what(); }

 private:
  Code code_;
};

}  // namespace mapweld::contract
