// A server that speaks enough of the contract to test clients against: maps in memory, answers that can be scripted,
// trouble that can be arranged. Every request is written down.
#pragma once

#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include <httplib.h>

#include "client/contract/image.h"
#include "client/contract/json.h"
#include "client/contract/problem_document.h"

namespace mapweld::testing {

struct FakeImage {
  std::string name;
  std::string bytes;
  bool ignored = false;
  std::string sha256;
};

// Images whose bytes begin with "bad" are refused as undecodable, those that begin with "dup" are ignored as too
// similar.
class FakeServer {
 public:
  FakeServer();
  ~FakeServer();
  FakeServer(const FakeServer&) = delete;
  FakeServer& operator=(const FakeServer&) = delete;

  std::string url() const { return "http://127.0.0.1:" + std::to_string(port_); }

  // Answers `method path` (no query) with this, from now on.
  void script(const std::string& method_and_path, int status, const std::string& body);
  void script(const std::string& method_and_path, int status, const contract::Json& body);
  void script_problem(const std::string& method_and_path, contract::Code code, const std::string& detail);
  // Answers each request for it with the next of these, the last one again and again.
  void script_sequence(const std::string& method_and_path, std::vector<contract::Json> bodies);

  // The next `count` uploads are stored, but the connection breaks before the answer is through.
  void break_after_storing(int count);
  // The next `count` uploads are answered 503 and not stored.
  void be_busy(int count);
  // A batch with more images than this is answered 413.
  void take_at_most(std::size_t images);

  std::vector<FakeImage> images(const std::string& map) const;  // in the order of their arrival
  std::vector<std::string> requests() const;                    // "POST /v1/maps?limit=2"
  std::vector<std::string> bodies() const;                      // of the same requests
  std::vector<std::string> authorizations() const;              // their Authorization fields; empty: none
  std::vector<std::string> idempotency_keys() const;            // and their Idempotency-Key fields
  std::size_t requests_of(const std::string& beginning) const;

 private:
  struct Scripted {
    int status = 200;
    std::vector<std::string> bodies;
    std::size_t next = 0;
  };

  bool answer_scripted(const httplib::Request& request, httplib::Response& response);
  void answer_as_a_server(const httplib::Request& request, httplib::Response& response);
  void answer_upload(const std::string& map, const std::vector<std::pair<std::string, std::string>>& files, bool batch,
                     httplib::Response& response);
  void answer_page(const httplib::Request& request, const contract::Json& items, httplib::Response& response);
  contract::BatchItem store(const std::string& map, const std::string& name, const std::string& bytes);

  httplib::Server server_;
  int port_ = 0;
  std::thread thread_;
  mutable std::mutex mutex_;
  std::map<std::string, Scripted> scripted_;
  std::map<std::string, std::vector<FakeImage>> maps_;
  std::vector<std::string> requests_;
  std::vector<std::string> bodies_;
  std::vector<std::string> authorizations_;
  std::vector<std::string> idempotency_keys_;
  int to_break_ = 0;
  int to_be_busy_ = 0;
  std::size_t most_images_ = contract::kMaxBatchImages;
};

}  // namespace mapweld::testing
