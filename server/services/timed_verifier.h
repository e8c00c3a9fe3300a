// A verifier that knows how long it took.
#pragma once

#include "core/geometry/pair_verifier.h"
#include "server/metrics/metrics.h"

namespace mapweld::server {

// Adds up the time of its verifications. Belongs to one thread.
class TimedVerifier final : public PairVerifier {
 public:
  explicit TimedVerifier(const PairVerifier& verifier) : verifier_(verifier) {}

  Verification verify(const AppearanceVector& a, const AppearanceVector& b) const override {
    const Stopwatch watch;
    Verification verification = verifier_.verify(a, b);
    elapsed_s_ += watch.elapsed_s();
    return verification;
  }
  std::string version() const override { return verifier_.version(); }
  const VerifierOptions& options() const override { return verifier_.options(); }

  double elapsed_s() const { return elapsed_s_; }

 private:
  const PairVerifier& verifier_;
  mutable double elapsed_s_ = 0;
};

}  // namespace mapweld::server
