// Ids that nobody else has.
#pragma once

#include <string>

#include <boost/uuid/random_generator.hpp>
#include <boost/uuid/uuid_io.hpp>

namespace mapweld::server {

// A version 4 UUID (RFC 9562), lower case.
inline std::string make_uuid() { return to_string(boost::uuids::random_generator{}()); }

}  // namespace mapweld::server
