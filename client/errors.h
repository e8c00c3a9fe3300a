// What the client library throws, apart from std::invalid_argument for arguments that cannot be right.
#pragma once

#include <stdexcept>
#include <string>
#include <utility>

#include "client/contract/problem_document.h"

namespace mapweld::client {

// The server answered, and its answer is no. `problem().code` is the stable word of docs/http-api.md; empty when what
// answered did not speak the contract (a proxy, another program).
class ServerProblem : public std::runtime_error {
 public:
  explicit ServerProblem(contract::Problem problem, double retry_after_s = 0);
  const contract::Problem& problem() const { return problem_; }
  int status() const { return problem_.status; }
  const std::string& code() const { return problem_.code; }
  const std::string& detail() const { return problem_.detail; }
  const std::string& request_id() const { return problem_.request_id; }
  // When to ask again, as the server put it; 0 when it did not say.
  double retry_after_s() const { return retry_after_s_; }

 private:
  contract::Problem problem_;
  double retry_after_s_;
};

// No answer: nothing listens there, the connection broke, or the time was up. Whether a request that had been sent took
// effect is not known.
class ConnectionError : public std::runtime_error {
  using std::runtime_error::runtime_error;
};

// The server answered yes with something that is not the contract's.
class UnexpectedAnswer : public std::runtime_error {
  using std::runtime_error::runtime_error;
};

}  // namespace mapweld::client
