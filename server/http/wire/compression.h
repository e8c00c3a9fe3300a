// Replies that are sent as gzip (RFC 1952) to clients that take it.
#pragma once

#include <string_view>

#include "server/http/message.h"

namespace mapweld::server {

// Whether `accept_encoding`, the value of such a field, allows gzip and does not prefer the bytes as they are
// (RFC 9110, section 12.5.3). An empty one does not.
bool accepts_gzip(std::string_view accept_encoding);

// Text that is worth it; not pictures, which are compressed, nor event streams, which are to arrive at once.
bool is_compressible(std::string_view content_type);

// Replaces the body, when it has 1 KiB or more, or the stream, piece by piece. An ETag becomes weak: the bytes are
// others.
void compress(Reply& reply);

}  // namespace mapweld::server
