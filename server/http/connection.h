// One TCP connection of the server, read with limits: the part of HTTP/1.1 that must withstand strangers.
//
// The head of a request (request line and header fields) is read and checked here as a whole before the HTTP library
// parses it, and the body is read here to its declared end, so that no line, number of fields, chunk or missing length
// can cost more memory or time than ConnectionLimits allow.
#pragma once

#include <atomic>
#include <chrono>
#include <cstdint>
#include <functional>
#include <string>
#include <string_view>

#include <httplib.h>

namespace mapweld::server {

struct ConnectionLimits {
  std::size_t max_head_bytes = 16 * 1024;  // request line and header fields together
  int idle_timeout_ms = 5'000;             // a kept-alive connection without a request
  int head_timeout_ms = 10'000;            // from the first byte of a head to its last
  int body_idle_timeout_ms = 10'000;       // between two pieces of a body
  int body_timeout_ms = 120'000;           // a whole body
  int write_timeout_ms = 10'000;           // between two pieces of a reply
  int linger_ms = 1'000;                   // before closing on a client that still sends
};

// How the body of a request is framed (RFC 9112, section 6).
enum class Framing : std::uint8_t { kNone, kLength, kChunked };

// Used by one thread. Does not own the socket.
class Connection final : public httplib::Stream {
 public:
  // `draining`: once true, only a request that has begun to arrive is still taken.
  Connection(socket_t socket, const ConnectionLimits& limits, const std::atomic<bool>& draining);

  // Waits for the first byte of a request. False: closed, idle for too long, draining, or `give_up` said so (asked
  // every 50 ms, so that an idle connection can hand its thread to one that waits).
  bool wait_for_request(const std::function<bool()>& give_up);

  enum class Head : std::uint8_t {
    kComplete,
    kClosed,  // by the client, before it was complete
    kTimeout,
    kTooLarge,
    kMalformed,  // bare line feeds, folded or nameless fields, control characters, contradicting or unknown framing
  };
  // Reads the next head. What the library reads afterwards is this head without the fields that the server does not
  // let it act on: Range, Accept-Encoding, Expect, Content-Encoding and those that frame the body.
  Head read_head();

  Framing framing() const { return framing_; }
  bool has_length() const { return framing_ == Framing::kLength; }
  std::uint64_t content_length() const { return content_length_; }
  const std::string& content_encoding() const { return content_encoding_; }  // empty: none
  const std::string& content_type() const { return content_type_; }

  enum class Body : std::uint8_t { kComplete, kTooLarge, kMalformed, kTimeout, kClosed, kBusy };
  // Reads the body to its end, at most `max_bytes` of it, into `body`; asks the client to go on where it expects to be
  // asked (100-continue). `reserve(bytes)`: is called before the body grows by so much; false ends it with kBusy.
  Body read_body(std::size_t max_bytes, std::string& body, const std::function<bool(std::size_t)>& reserve);

  // The body of the present request has been read to its end: the next request can follow.
  bool body_consumed() const { return body_consumed_; }

  // Lets the client read the reply before the connection closes: ends our side, then discards what still arrives.
  void linger();

  bool write_all(std::string_view data);

  // What the library asks of a stream.
  bool is_readable() const override;
  bool is_writable() const override;
  ssize_t read(char* data, size_t size) override;  // of the head that was read; never of the body
  ssize_t write(const char* data, size_t size) override;
  void get_remote_ip_and_port(std::string& ip, int& port) const override;
  void get_local_ip_and_port(std::string& ip, int& port) const override;
  socket_t socket() const override { return socket_; }

 private:
  using Clock = std::chrono::steady_clock;

  enum class Fill : std::uint8_t { kData, kClosed, kTimeout };
  // Receives some bytes into `buffer_`, waiting at most until `deadline`.
  Fill fill(Clock::time_point deadline);
  bool wait(short events, int timeout_ms) const;

  Head check_head(std::string_view head);
  Head take_field(std::string_view line, bool& pass_on);

  Body read_bytes(std::uint64_t count, std::string& body, Clock::time_point deadline,
                  const std::function<bool(std::size_t)>& reserve);
  Body read_line(std::string& line, Clock::time_point deadline);
  Body read_chunks(std::size_t max_bytes, std::string& body, Clock::time_point deadline,
                   const std::function<bool(std::size_t)>& reserve);

  const socket_t socket_;
  const ConnectionLimits limits_;
  const std::atomic<bool>& draining_;

  std::string buffer_;  // received, not yet used
  std::string head_;    // what the library reads
  std::size_t head_position_ = 0;

  Framing framing_ = Framing::kNone;
  std::uint64_t content_length_ = 0;
  std::string content_encoding_;
  std::string content_type_;
  bool expects_continue_ = false;
  bool body_consumed_ = true;
};

}  // namespace mapweld::server
