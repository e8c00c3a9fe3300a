// HTTPS, with certificates that are made here.
#include <chrono>
#include <csignal>
#include <filesystem>
#include <fstream>
#include <memory>
#include <string>
#include <thread>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <openssl/evp.h>
#include <openssl/pem.h>
#include <openssl/x509.h>

#include "tests/server/http/http_server_under_test.h"

namespace mapweld::server {
namespace {

using ::testing::HasSubstr;

template <typename T, void (*kFree)(T*)>
struct Freed {
  void operator()(T* object) const { kFree(object); }
};

// Writes a key, and a certificate for it that it signed itself, with this serial number.
void make_certificate(const std::filesystem::path& certificate, const std::filesystem::path& key, long serial) {
  const std::unique_ptr<EVP_PKEY, Freed<EVP_PKEY, EVP_PKEY_free>> pair(EVP_EC_gen("P-256"));
  const std::unique_ptr<X509, Freed<X509, X509_free>> x509(X509_new());
  X509_set_version(x509.get(), 2);
  ASN1_INTEGER_set(X509_get_serialNumber(x509.get()), serial);
  X509_gmtime_adj(X509_getm_notBefore(x509.get()), 0);
  X509_gmtime_adj(X509_getm_notAfter(x509.get()), 3600);
  X509_NAME_add_entry_by_txt(X509_get_subject_name(x509.get()), "CN", MBSTRING_ASC,
                             reinterpret_cast<const unsigned char*>("localhost"), -1, -1, 0);
  X509_set_issuer_name(x509.get(), X509_get_subject_name(x509.get()));
  X509_set_pubkey(x509.get(), pair.get());
  X509_sign(x509.get(), pair.get(), EVP_sha256());
  const std::unique_ptr<FILE, int (*)(FILE*)> certificate_file(std::fopen(certificate.c_str(), "w"), std::fclose);
  PEM_write_X509(certificate_file.get(), x509.get());
  const std::unique_ptr<FILE, int (*)(FILE*)> key_file(std::fopen(key.c_str(), "w"), std::fclose);
  PEM_write_PrivateKey(key_file.get(), pair.get(), nullptr, nullptr, 0, nullptr, nullptr);
}

class Https : public HttpServerTest {
 protected:
  void SetUp() override {
    std::signal(SIGPIPE, SIG_IGN);
    folder_ = std::filesystem::temp_directory_path() / ("mapweld-tls-" + std::to_string(::getpid()));
    std::filesystem::create_directories(folder_);
    options_.tls_certificate = folder_ / "certificate.pem";
    options_.tls_key = folder_ / "key.pem";
    make_certificate(options_.tls_certificate, options_.tls_key, 1);
  }
  void TearDown() override {
    HttpServerTest::TearDown();
    std::filesystem::remove_all(folder_);
  }
  std::unique_ptr<httplib::SSLClient> https() const {
    auto client = std::make_unique<httplib::SSLClient>("127.0.0.1", port_);
    client->enable_server_certificate_verification(false);
    return client;
  }
  // Of the certificate that a new connection is shown.
  long serial() const {
    long serial = -1;
    const std::unique_ptr<SSL_CTX, Freed<SSL_CTX, SSL_CTX_free>> context(SSL_CTX_new(TLS_client_method()));
    const std::unique_ptr<BIO, Freed<BIO, BIO_free_all>> bio(BIO_new_ssl_connect(context.get()));
    BIO_set_conn_hostname(bio.get(), ("127.0.0.1:" + std::to_string(port_)).c_str());
    if (BIO_do_handshake(bio.get()) != 1) return -1;
    SSL* ssl = nullptr;
    BIO_get_ssl(bio.get(), &ssl);
    const std::unique_ptr<X509, Freed<X509, X509_free>> shown(SSL_get1_peer_certificate(ssl));
    if (shown) serial = ASN1_INTEGER_get(X509_get0_serialNumber(shown.get()));
    return serial;
  }

  std::filesystem::path folder_;
  HttpOptions options_;
};

TEST_F(Https, ServesAsHttpDoes) {
  start(options_);
  const auto client = https();
  client->set_keep_alive(true);
  EXPECT_EQ(client->Get("/hello")->body, "hello");
  const std::string large(3'000'000, 'x');
  EXPECT_EQ(client->Post("/echo", large, "text/plain")->body, large);
  const auto stream = client->Get("/stream");
  ASSERT_TRUE(stream);
  EXPECT_THAT(stream->body, ::testing::EndsWith("line 49999\n"));
  EXPECT_EQ(client->Get("/nothing")->status, 404);
}

TEST_F(Https, TalksNoPlainHttpAndNoOldTls) {
  start(options_);
  EXPECT_EQ(exchange("GET /hello HTTP/1.1\r\nHost: x\r\n\r\n").find("hello"), std::string::npos);
  const std::unique_ptr<SSL_CTX, Freed<SSL_CTX, SSL_CTX_free>> context(SSL_CTX_new(TLS_client_method()));
  SSL_CTX_set_min_proto_version(context.get(), TLS1_VERSION);
  SSL_CTX_set_max_proto_version(context.get(), TLS1_1_VERSION);
  SSL_CTX_set_security_level(context.get(), 0);
  const std::unique_ptr<BIO, Freed<BIO, BIO_free_all>> bio(BIO_new_ssl_connect(context.get()));
  BIO_set_conn_hostname(bio.get(), ("127.0.0.1:" + std::to_string(port_)).c_str());
  EXPECT_NE(BIO_do_handshake(bio.get()), 1);
}

TEST_F(Https, AHandshakeThatStandsStillIsGivenUpAndHoldsNobody) {
  options_.threads = 1;
  options_.connection.head_timeout_ms = 300;
  start(options_);
  RawClient silent(port_);
  RawClient slow(port_);
  slow.send("\x16\x03\x01");
  EXPECT_TRUE(https()->Get("/hello"));
  EXPECT_TRUE(silent.closed_within(5));
  EXPECT_TRUE(slow.closed_within(5));
}

TEST_F(Https, AnotherCertificateIsTakenWithoutARestart) {
  start(options_);
  EXPECT_EQ(serial(), 1);
  const auto before = https();
  before->set_keep_alive(true);
  EXPECT_TRUE(before->Get("/hello"));
  make_certificate(options_.tls_certificate, options_.tls_key, 2);
  server_->reload_certificate();
  EXPECT_EQ(serial(), 2);
  EXPECT_TRUE(before->Get("/hello"));
  std::ofstream(options_.tls_key) << "nonsense";
  EXPECT_THROW(server_->reload_certificate(), std::runtime_error);
  EXPECT_EQ(serial(), 2);
}

TEST_F(Https, WhatCannotBeUsedIsSaid) {
  Metrics metrics;
  const auto complaint = [&](const std::string& certificate, const std::string& key) -> std::string {
    HttpOptions options;
    options.tls_certificate = certificate;
    options.tls_key = key;
    try {
      HttpServer(options, Router{}, metrics);
      return "";
    } catch (const std::runtime_error& error) {
      return error.what();
    }
  };
  EXPECT_EQ(complaint(options_.tls_certificate, options_.tls_key), "");
  EXPECT_THAT(complaint(options_.tls_certificate, ""), HasSubstr("key"));
  EXPECT_THAT(complaint("/nowhere.pem", options_.tls_key), HasSubstr("/nowhere.pem"));
  const std::filesystem::path other = folder_ / "other.pem";
  make_certificate(folder_ / "unused.pem", other, 3);
  EXPECT_THAT(complaint(options_.tls_certificate, other), HasSubstr("other.pem"));
}

}  // namespace
}  // namespace mapweld::server
