#include "server/http/problem.h"

#include <new>

#include <spdlog/spdlog.h>

#include "core/errors.h"
#include "schema/engine/store_error.h"

namespace mapweld::server {
namespace {

using contract::Code;

struct Verdict {
  Code code;
  std::string detail;
};

Verdict of_store(const StoreError& error) {
  switch (error.kind()) {
    case StoreErrorKind::kNoSpace:
      return {"no_space", "The server's disk or quota is full. Nothing was stored."};
    case StoreErrorKind::kBusy:
      return {"busy", "The database is held by another process. Try again."};
    case StoreErrorKind::kNoResources:
      return {"busy", "The server is short of file descriptors or memory. Try again."};
    case StoreErrorKind::kGone:
      return {"internal_error", "The server's data folder was removed or replaced while it runs. Nothing was stored."};
    default:
      return {"internal_error", "The server could not use its database. Nothing was stored."};
  }
}

Verdict verdict_on(const std::exception_ptr& error, const std::string& request_id) {
  try {
    std::rethrow_exception(error);
  } catch (const contract::ContractError& e) {
    return {e.code(), e.detail()};
  } catch (const CodedError& e) {
    return {Code::find(e.code()), e.what()};
  } catch (const StoreError& e) {
    spdlog::error("request {}: store: {}: {}", request_id, to_string(e.kind()), e.what());
    return of_store(e);
  } catch (const std::bad_alloc&) {
    spdlog::error("request {}: out of memory", request_id);
    return {"busy", "The server is short of memory. Try again, or send less at once."};
  } catch (const std::exception& e) {
    spdlog::error("request {}: {}", request_id, e.what());
  } catch (...) {
    spdlog::error("request {}: an exception of unknown type", request_id);
  }
  return {"internal_error", "The server failed to answer. Its log says why, under this request_id."};
}

}  // namespace

contract::Problem problem_of(const std::exception_ptr& error, const std::string& request_id) {
  const Verdict verdict = verdict_on(error, request_id);
  return contract::problem_of(verdict.code, verdict.detail, request_id);
}

Reply problem_reply(const contract::Problem& problem) {
  Reply reply;
  reply.status = problem.status;
  reply.content_type = "application/problem+json";
  reply.body = contract::dump(contract::Json(problem));
  const bool may_pass =
      problem.status == 503 || problem.code == "rate_limited" || problem.code == "idempotency_in_progress";
  if (may_pass) reply.headers.emplace_back("Retry-After", "1");
  return reply;
}

}  // namespace mapweld::server
