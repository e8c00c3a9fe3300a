// The one place where what went wrong becomes an answer: exceptions in, application/problem+json out.
#pragma once

#include <exception>
#include <string>

#include "client/contract/problem_document.h"
#include "server/http/message.h"

namespace mapweld::server {

// The problem for an exception of any layer (docs/http-api.md, "Codes"). What nobody foresaw is internal_error, whose
// detail tells a client nothing of the inside: that goes to the log, under the request id.
contract::Problem problem_of(const std::exception_ptr& error, const std::string& request_id);

Reply problem_reply(const contract::Problem& problem);

}  // namespace mapweld::server
