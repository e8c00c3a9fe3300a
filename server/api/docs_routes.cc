#include <string>
#include <string_view>

#include <openssl/evp.h>

#include "server/api/api.h"
#include "server/api/description/texts.h"
#include "server/api/replies.h"

namespace mapweld::server {
namespace {

std::string to_base64(const Sha256& hash) {
  std::string text(4 * ((hash.size() + 2) / 3) + 1, '\0');
  text.resize(static_cast<std::size_t>(
      EVP_EncodeBlock(reinterpret_cast<unsigned char*>(text.data()), hash.data(), static_cast<int>(hash.size()))));
  return text;
}

// Names what stands in the page's one element of this name, so that the browser runs that and nothing else.
std::string source_of(std::string_view page, const std::string& element) {
  const std::size_t begin = page.find("<" + element + ">") + element.size() + 2;
  const std::string_view content = page.substr(begin, page.find("</" + element + ">", begin) - begin);
  return "'sha256-" + to_base64(sha256({reinterpret_cast<const std::uint8_t*>(content.data()), content.size()})) + "'";
}

}  // namespace

void add_docs_routes(Router& router) {
  const std::string policy = "default-src 'none'; style-src " + source_of(docs_page(), "style") + "; script-src " +
                             source_of(docs_page(), "script") +
                             "; connect-src 'self'; base-uri 'none'; form-action 'none'; frame-ancestors 'none'";
  router.add({.method = "GET",
              .pattern = "/docs",
              .role = Role::kAnybody,
              .says = {.operation = "getDocs", .answers = {{200, {{"text/html"}}}, {304}}},
              .handler = [policy](const Request&) {
                Reply reply;
                reply.content_type = "text/html; charset=utf-8";
                reply.body = docs_page();
                reply.headers = {{"Content-Security-Policy", policy}, {"X-Content-Type-Options", "nosniff"}};
                return tagged_by_content(std::move(reply));
              }});
}

}  // namespace mapweld::server
