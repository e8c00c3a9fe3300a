#include "server/access/addresses.h"

#include <array>
#include <cstdint>
#include <cstring>
#include <memory>

#include <arpa/inet.h>
#include <netdb.h>
#include <netinet/in.h>
#include <sys/socket.h>

#include "server/http/wire/text.h"

namespace mapweld::server {
namespace {

bool is_loopback(const in_addr& four) { return ntohl(four.s_addr) >> 24 == IN_LOOPBACKNET; }

bool is_loopback(const in6_addr& six) {
  return IN6_IS_ADDR_LOOPBACK(&six) || (IN6_IS_ADDR_V4MAPPED(&six) && six.s6_addr[12] == IN_LOOPBACKNET);
}

std::string with_port(std::string_view host, std::string_view port) {
  const std::size_t colon = host.rfind(':');
  const bool has_port = colon != std::string_view::npos && host.find(']', colon) == std::string_view::npos;
  return lower(host) + (has_port ? "" : ":" + std::string(port));
}

}  // namespace

bool is_loopback_address(const std::string& address) {
  in_addr four{};
  if (::inet_pton(AF_INET, address.c_str(), &four) == 1) return is_loopback(four);
  in6_addr six{};
  return ::inet_pton(AF_INET6, address.c_str(), &six) == 1 && is_loopback(six);
}

bool is_loopback(const std::string& host) {
  addrinfo* found = nullptr;
  addrinfo hints{};
  hints.ai_socktype = SOCK_STREAM;
  if (host.empty() || ::getaddrinfo(host.c_str(), nullptr, &hints, &found) != 0) return false;
  const std::unique_ptr<addrinfo, decltype(&::freeaddrinfo)> owned(found, ::freeaddrinfo);
  for (const addrinfo* address = found; address != nullptr; address = address->ai_next) {
    const bool is_own =
        address->ai_family == AF_INET    ? is_loopback(reinterpret_cast<sockaddr_in*>(address->ai_addr)->sin_addr)
        : address->ai_family == AF_INET6 ? is_loopback(reinterpret_cast<sockaddr_in6*>(address->ai_addr)->sin6_addr)
                                         : false;
    if (!is_own) return false;
  }
  return found != nullptr;
}

std::string network_of(const std::string& address) {
  in6_addr six{};
  if (::inet_pton(AF_INET6, address.c_str(), &six) != 1) return address;
  if (IN6_IS_ADDR_V4MAPPED(&six)) {
    std::array<char, INET_ADDRSTRLEN> text{};
    ::inet_ntop(AF_INET, &six.s6_addr[12], text.data(), text.size());
    return text.data();
  }
  std::memset(&six.s6_addr[8], 0, 8);
  std::array<char, INET6_ADDRSTRLEN> text{};
  ::inet_ntop(AF_INET6, &six, text.data(), text.size());
  return std::string(text.data()) + "/64";
}

bool is_same_origin(std::string_view origin, std::string_view host) {
  const std::size_t scheme_end = origin.find("://");
  if (scheme_end == std::string_view::npos || host.empty() || origin.find(',') != std::string_view::npos) return false;
  const std::string scheme = lower(origin.substr(0, scheme_end));
  if (scheme != "http" && scheme != "https") return false;
  const char* const port = scheme == "https" ? "443" : "80";
  return with_port(origin.substr(scheme_end + 3), port) == with_port(host, port);
}

}  // namespace mapweld::server
