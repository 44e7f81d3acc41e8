// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <memory>
#include <span>
#include <string>
#include <string_view>

struct evp_md_ctx_st;

namespace cyclorama::scene_distribution {

/// Computes the SHA-256 (FIPS 180-4) of bytes that arrive in pieces, with OpenSSL. Thread-bound.
class Sha256 {
 public:
  Sha256();
  void add(std::span<const std::byte> bytes);
  /// Returns 64 lower-case digits. Ends the computation: nothing may be added afterwards.
  [[nodiscard]] std::string hexadecimal();

 private:
  struct Free {
    void operator()(evp_md_ctx_st* context) const;
  };
  std::unique_ptr<evp_md_ctx_st, Free> context_;
};

[[nodiscard]] std::string sha256_of(std::string_view text);

/// Returns true for 64 lower-case hexadecimal digits. Such a text is also safe as a file name.
[[nodiscard]] bool is_sha256(std::string_view text);

}  // namespace cyclorama::scene_distribution
