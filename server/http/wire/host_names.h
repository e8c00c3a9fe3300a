// For whom a request may be: a page that lets its own name point at this server (DNS rebinding) is told that it does
// not live here.
#pragma once

#include <set>
#include <string>
#include <string_view>
#include <vector>

namespace mapweld::server {

// Immutable; any thread.
class HostNames {
 public:
  // `bound`: the address or name that the server listens on. `allowed`: more names; "*" allows every one.
  HostNames(const std::string& bound, const std::vector<std::string>& allowed);

  // Whether `host`, the value of a Host field, is an address literal, localhost (or below it), the name of this machine
  // or one of the names given; with any port.
  bool know(std::string_view host) const;

 private:
  std::set<std::string> names_;
};

}  // namespace mapweld::server
