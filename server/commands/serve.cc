#include "server/commands/serve.h"

#include <algorithm>
#include <chrono>
#include <condition_variable>
#include <csignal>
#include <cstdio>
#include <iostream>
#include <map>
#include <memory>
#include <mutex>
#include <thread>

#include <CLI/CLI.hpp>
#include <opencv2/core/utility.hpp>
#include <spdlog/spdlog.h>
#include <sys/resource.h>
#include <unistd.h>

#include "core/feature/allocation.h"
#include "server/config.h"
#include "server/decoding/decoder_process.h"
#include "server/log.h"
#include "server/server.h"
#include "server/version.h"

namespace mapweld::server {
namespace {

constexpr std::chrono::milliseconds kStopWithin{4'500};  // after that, what still runs is left to the next start

// Connections are descriptors: as many as the system lets this process have.
void raise_descriptor_limit() {
  rlimit limit{};
  if (::getrlimit(RLIMIT_NOFILE, &limit) != 0) return;
  limit.rlim_cur = limit.rlim_max;
  ::setrlimit(RLIMIT_NOFILE, &limit);
}

// Waits for SIGTERM and SIGINT, and where there is a certificate for SIGHUP, on a thread of its own; every other thread
// has them blocked.
class Signals {
 public:
  explicit Signals(bool with_certificate) {
    sigemptyset(&signals_);
    sigaddset(&signals_, SIGTERM);
    sigaddset(&signals_, SIGINT);
    if (with_certificate) sigaddset(&signals_, SIGHUP);
    pthread_sigmask(SIG_BLOCK, &signals_, nullptr);
    std::signal(SIGPIPE, SIG_IGN);
  }

  // Calls server.stop() at the first signal; ends the process at the second, or when it takes too long. What is stored
  // is safe at any moment, so nothing is lost by that.
  void watch(Server& server) {
    thread_ = std::thread([this, &server] {
      int signal = SIGHUP;
      while (signal == SIGHUP) {
        sigwait(&signals_, &signal);
        if (finished()) return;
        if (signal == SIGHUP) reload(server);
      }
      spdlog::info("stopping: {}", signal == SIGTERM ? "SIGTERM" : "SIGINT");
      server.stop();
      const auto deadline = std::chrono::steady_clock::now() + kStopWithin;
      while (!finished()) {
        const auto left = deadline - std::chrono::steady_clock::now();
        const timespec wait{0, 50'000'000};
        if (left.count() > 0 && sigtimedwait(&signals_, nullptr, &wait) < 0) continue;
        if (finished()) return;
        spdlog::warn("stopped before everything was finished; it goes on at the next start");
        spdlog::shutdown();
        std::_Exit(left.count() > 0 ? 130 : 0);
      }
    });
  }

  void finish() {
    {
      const std::lock_guard lock(mutex_);
      finished_ = true;
    }
    pthread_kill(thread_.native_handle(), SIGTERM);  // where it still waits for one
    thread_.join();
  }

 private:
  static void reload(Server& server) {
    try {
      server.reload_certificate();
      spdlog::info("SIGHUP: the certificate was read again");
    } catch (const std::exception& error) {
      spdlog::error("SIGHUP: {}; the former certificate stays", error.what());
    }
  }

  bool finished() {
    const std::lock_guard lock(mutex_);
    return finished_;
  }

  sigset_t signals_{};
  std::mutex mutex_;
  bool finished_ = false;
  std::thread thread_;
};

void serve(const ServerConfig& config) {
  set_up_log(config.log_level, config.log_format);
  keep_freed_memory();
  raise_descriptor_limit();
  cv::setNumThreads(0);  // one image a thread
  const bool tls = !config.http.tls_certificate.empty();
  Signals signals(tls);
  Server server(config);
  const bool ipv6 = config.http.host.find(':') != std::string::npos;
  const std::string host = ipv6 ? "[" + config.http.host + "]" : config.http.host;
  const std::string url = (tls ? "https://" : "http://") + host + ":" + std::to_string(server.port());
  spdlog::info("mapweld-server {} over {}{}", version(), config.data.string(), config.read_only ? ", read-only" : "");
  std::cout << "listening on " << url << std::endl;
  signals.watch(server);
  server.run();
  signals.finish();
  spdlog::info("stopped");
}

}  // namespace

void add_serve_command(CLI::App& app) {
  const auto config = std::make_shared<ServerConfig>();
  const auto max_body_mb = std::make_shared<std::size_t>(config->http.max_body_bytes >> 20);
  const auto vocabulary = std::make_shared<std::string>();
  config->decoders = -1;
  CLI::App* command = app.add_subcommand("serve", "Serves the maps of a data folder over HTTP");
  command->add_option("--data", config->data, "Data folder; created when missing")->envname("MAPWELD_DATA")->required();
  command->add_option("--host", config->http.host, "Address to listen on")
      ->envname("MAPWELD_HOST")
      ->capture_default_str();
  command
      ->add_flag("--read-only", config->read_only,
                 "Change nothing: serve a folder at rest, which need not be writable; what would change something is "
                 "refused")
      ->envname("MAPWELD_READ_ONLY");
  command
      ->add_flag("--insecure", config->insecure,
                 "Listen on any address although there are no keys: whoever reaches it may do everything")
      ->envname("MAPWELD_INSECURE");
  command
      ->add_option("--cors-origin", config->access.cors_origins,
                   "Let pages of this origin use the server from a browser; may be repeated; * for any")
      ->envname("MAPWELD_CORS_ORIGIN")
      ->expected(1)
      ->take_all();
  command
      ->add_option("--rate", config->access.per_caller.per_s,
                   "Requests a second of one key, or of one address where there are no keys; 0: any number")
      ->envname("MAPWELD_RATE")
      ->check(CLI::NonNegativeNumber)
      ->capture_default_str();
  command->add_option("--port", config->http.port, "Port to listen on; 0 picks a free one and prints it")
      ->envname("MAPWELD_PORT")
      ->check(CLI::Range(0, 65535))
      ->capture_default_str();
  command
      ->add_option("--allowed-host", config->http.allowed_hosts,
                   "A name by which clients may call this server, beside its address; may be repeated; * allows any")
      ->envname("MAPWELD_ALLOWED_HOST");
  CLI::Option* certificate =
      command->add_option("--tls-cert", config->http.tls_certificate, "PEM file of a certificate: serves HTTPS")
          ->envname("MAPWELD_TLS_CERT");
  CLI::Option* key = command->add_option("--tls-key", config->http.tls_key, "PEM file of its key")
                         ->envname("MAPWELD_TLS_KEY")
                         ->needs(certificate);
  certificate->needs(key);
  command->add_option("--threads", config->http.threads, "Requests worked on at the same time")
      ->envname("MAPWELD_THREADS")
      ->check(CLI::Range(1, 1024))
      ->capture_default_str();
  command->add_option("--max-connections", config->http.max_connections, "Connections open at the same time")
      ->envname("MAPWELD_MAX_CONNECTIONS")
      ->check(CLI::Range(1, 1'000'000))
      ->capture_default_str();
  command->add_option("--extract-threads", config->extract_threads, "Images analysed at the same time; 0: one a core")
      ->envname("MAPWELD_EXTRACT_THREADS")
      ->check(CLI::Range(0, 256))
      ->capture_default_str();
  command
      ->add_option(
          "--decoders", config->decoders,
          "Processes that decode images, each in a sandbox; 0: decode in the server itself. Default: as many as "
          "images are analysed at the same time")
      ->envname("MAPWELD_DECODERS")
      ->check(CLI::Range(0, 256));
  command->add_option("--workers", config->merge_workers, "Merges that run at the same time")
      ->envname("MAPWELD_WORKERS")
      ->check(CLI::Range(1, 64))
      ->capture_default_str();
  command
      ->add_option("--verify-threads", config->verify_threads,
                   "Pairs verified at the same time by merges; 0: one a core")
      ->envname("MAPWELD_VERIFY_THREADS")
      ->check(CLI::Range(0, 256))
      ->capture_default_str();
  command
      ->add_option("--checkpoint-interval", config->checkpoint_interval_s,
                   "Seconds between the checkpoints of a running merge, where they are cheap enough")
      ->envname("MAPWELD_CHECKPOINT_INTERVAL")
      ->check(CLI::Range(0.001, 60.0))
      ->capture_default_str();
  command->add_option("--max-body", *max_body_mb, "Largest request body in MiB")
      ->envname("MAPWELD_MAX_BODY")
      ->check(CLI::Range(1, 4096))
      ->capture_default_str();
  command->add_option("--cache-mb", config->cache_mb, "Memory for maps in use, in MiB")
      ->envname("MAPWELD_CACHE_MB")
      ->capture_default_str();
  command->add_option("--vocabulary", *vocabulary, "Vocabulary file of maps that name none; default: the shipped one")
      ->envname("MAPWELD_VOCABULARY")
      ->check(CLI::ExistingFile);
  command->add_option("--log-level", config->log_level, "How much is logged")
      ->envname("MAPWELD_LOG_LEVEL")
      ->check(CLI::IsMember({"trace", "debug", "info", "warning", "error", "off"}))
      ->capture_default_str();
  command->add_option("--log-format", config->log_format, "How the log is written: text, or a JSON document a line")
      ->envname("MAPWELD_LOG_FORMAT")
      ->transform(CLI::CheckedTransformer(
          std::map<std::string, LogFormat>{{"text", LogFormat::kText}, {"json", LogFormat::kJson}}))
      ->default_str("text");
  command->callback([config, max_body_mb, vocabulary] {
    config->access.per_caller.burst = std::max(1.0, 2 * config->access.per_caller.per_s);
    config->http.max_body_bytes = *max_body_mb << 20;
    config->http.max_bodies_bytes = std::max(config->http.max_bodies_bytes, 2 * config->http.max_body_bytes);
    if (!vocabulary->empty()) config->vocabulary = *vocabulary;
    try {
      serve(*config);
    } catch (const std::exception& error) {
      std::cerr << "mapweld-server: " << error.what() << std::endl;
      throw CLI::RuntimeError(1);
    }
  });
}

void add_decode_command(CLI::App& app) {
  CLI::App* command = app.add_subcommand("decode-images", "What the server starts to decode images in a sandbox");
  command->group("");  // not for people
  command->callback([] { throw CLI::RuntimeError(run_decoder_process()); });
}

}  // namespace mapweld::server
