#include "server/http/wire/host_names.h"

#include <utility>

#include <boost/asio/ip/address.hpp>
#include <boost/asio/ip/host_name.hpp>

#include "server/http/wire/text.h"

namespace mapweld::server {
namespace {

bool is_address(const std::string& name) {
  boost::system::error_code error;
  boost::asio::ip::make_address(name, error);
  return !error;
}

}  // namespace

HostNames::HostNames(const std::string& bound, const std::vector<std::string>& allowed)
    : names_{"localhost", lower(bound)} {
  boost::system::error_code error;
  const std::string machine = boost::asio::ip::host_name(error);
  if (!error) names_.insert(lower(machine));
  for (const std::string& name : allowed) names_.insert(lower(name));
}

bool HostNames::know(std::string_view host) const {
  std::string name = lower(host);
  if (const std::size_t end = name.find(']'); name.starts_with('[') && end != std::string::npos) {  // [::1]:8080
    name = name.substr(1, end - 1);
  } else {
    name = name.substr(0, name.find(':'));
  }
  return names_.contains(name) || names_.contains("*") || name.ends_with(".localhost") || is_address(name);
}

}  // namespace mapweld::server
