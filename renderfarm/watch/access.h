// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

#include "common/base/result.h"

namespace cyclorama::watch {

/// Decides who may watch. With a token: requests that send the token, as `Authorization: Bearer TOKEN` or as the
/// password of the user "operator" (browsers prompt for it). Without a token: only requests whose Host header names
/// this machine, so that a foreign page in a local browser cannot read the farm's data (DNS rebinding). A value;
/// reentrant.
class Access {
 public:
  static constexpr const char* kUser = "operator";
  static constexpr std::size_t kMinTokenLength = 16;

  /// Grants access without a token.
  Access() = default;
  /// Reads the token: the first line of the file, without surrounding blanks. Errors: kBadData if it is shorter than
  /// kMinTokenLength or not printable ASCII; otherwise those of read_text_file().
  static Result<Access> read(const std::filesystem::path& token_file);
  explicit Access(const std::string& token);

  [[nodiscard]] bool has_token() const { return !accepted_.empty(); }
  /// Returns true if a request is permitted. The arguments are its headers; empty if absent. Takes the same time for
  /// every wrong token.
  [[nodiscard]] bool admits(const std::string& authorization, const std::string& host) const;

 private:
  using Digest = std::array<unsigned char, 32>;
  std::vector<Digest> accepted_;  ///< SHA-256 of each accepted header.
};

}  // namespace cyclorama::watch
