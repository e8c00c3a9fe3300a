// Stored maps as a merge's input, and a verifier that asks each pair once: what the measurements of merge orders
// work on.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <span>
#include <string>
#include <unordered_map>

#include "core/merge/merge_input.h"

namespace mapweld::benchmark_support {

// Reads maps of a data folder that no server has open, in the order given. Throws std::runtime_error when one is
// missing.
MergeInput load_stored_maps(const std::filesystem::path& data_folder, std::span<const std::string> names);

// Two of them: reads maps `first` and `second` of a data folder that no server has open. Throws std::runtime_error when
// one is missing.
MergeInput load_stored_pair(const std::filesystem::path& data_folder, const std::string& first,
                            const std::string& second);

// Remembers verdicts by the two images' addresses, so that every method is told the same at the cost of one. The
// geometry is not kept. Not thread-safe.
class RememberingVerifier final : public PairVerifier {
 public:
  // `file`: where verdicts are kept from run to run; empty for nowhere. Verdicts of other images are not found there.
  RememberingVerifier(std::shared_ptr<const PairVerifier> verifier, std::filesystem::path file);
  ~RememberingVerifier() override;
  Verification verify(const AppearanceVector& a, const AppearanceVector& b) const override;
  std::string version() const override { return verifier_->version(); }
  const VerifierOptions& options() const override { return verifier_->options(); }

 private:
  std::uint64_t content_of(const AppearanceVector& image) const;
  std::shared_ptr<const PairVerifier> verifier_;
  std::filesystem::path file_;
  mutable std::unordered_map<const AppearanceVector*, std::uint64_t> contents_;
  struct Verdict {
    std::uint64_t pair = 0;
    std::uint16_t matches = 0, inliers = 0;
    std::uint8_t accepted = 0, reason = 0;
  };
  mutable std::unordered_map<std::uint64_t, Verdict> verdicts_;
  std::size_t stored_ = 0;
};

}  // namespace mapweld::benchmark_support
