// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

#include "common/base/result.h"

namespace cyclorama {

/// Who may look. With a token: who sends it, as `Authorization: Bearer TOKEN`, or as the password of the user
/// "operator" (what a browser asks for). Without one, only requests that name this machine as their host, so that no
/// foreign page in a local browser can read along (DNS rebinding). A value; reentrant.
class Access {
 public:
  static constexpr const char* kUser = "operator";
  static constexpr std::size_t kShortestToken = 16;

  /// Without a token.
  Access() = default;
  /// The file's first line, without the blanks around it. kBadData  shorter than kShortestToken, or not printable
  /// ASCII. Else as read_text_file().
  static Result<Access> read(const std::filesystem::path& token_file);
  explicit Access(const std::string& token);

  [[nodiscard]] bool has_token() const { return !accepted_.empty(); }
  /// Both as the request's headers have them; empty when it has none. Takes the same time for every wrong token.
  [[nodiscard]] bool admits(const std::string& authorization, const std::string& host) const;

 private:
  using Digest = std::array<unsigned char, 32>;
  std::vector<Digest> accepted_;  ///< SHA-256 of the whole header.
};

}  // namespace cyclorama
