// Cursors of pages that only this server can have given, and only for the list that they go on in.
#pragma once

#include <string>

#include "schema/store.h"
#include "server/api/replies.h"

namespace mapweld::server {

// A cursor on its way out is what the service gave, sealed (HMAC-SHA256, 128 bits) together with its list: path and
// query, but for the page's size. Copies are cheap; any thread.
class Cursors {
 public:
  // With the secret of the database, which is made when it has none.
  explicit Cursors(Store& store);

  // `list(page)`, a page of the contract, as a reply. Throws ContractError invalid_parameter for a cursor that was not
  // given for this list, or a limit that is none.
  template <typename List>
  Reply reply(const Request& request, const List& list) const {
    auto page = list(page_in(request));
    if (page.next_cursor) page.next_cursor = sealed(request, *page.next_cursor);
    return json_reply(200, page);
  }

 private:
  PageRequest page_in(const Request& request) const;
  std::string sealed(const Request& request, const std::string& cursor) const;

  std::string secret_;
};

}  // namespace mapweld::server
