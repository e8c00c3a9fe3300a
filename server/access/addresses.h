// Addresses and origins: what is this machine's own, and what is a stranger's page.
#pragma once

#include <string>
#include <string_view>

namespace mapweld::server {

// Whether `host`, a name or an address, means this machine only, whatever it resolves to. False for what does not
// resolve. Asks the resolver: may take seconds.
bool is_loopback(const std::string& host);

// The same of a numeric address; at once.
bool is_loopback_address(const std::string& address);

// Who counts as one in a rate: an IPv4 address, the /64 of an IPv6 one.
std::string network_of(const std::string& address);

// Whether a page of this Origin was loaded from the server that the request's Host names: same host, same port. An
// Origin of "null" or a list is not.
bool is_same_origin(std::string_view origin, std::string_view host);

}  // namespace mapweld::server
