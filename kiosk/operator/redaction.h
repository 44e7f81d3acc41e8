// SPDX-License-Identifier: Apache-2.0
/// Secrets taken out of texts that leave the museum.
#pragma once

#include <filesystem>
#include <functional>
#include <set>
#include <string>
#include <string_view>
#include <vector>

namespace cyclorama {

/// What must not leave, learnt from the settings in use: lines of private keys, words of password files, the PIN's
/// hash. A value. It takes out, besides those, whatever looks like a secret: blocks of PEM, and the values of settings
/// whose name has one of the words pin, password, secret, token, key, credential, auth or phrase ("key = " alone is a
/// path).
class Redaction {
 public:
  /// Texts shorter than 4 bytes are not taken for secrets: every word would be torn. Of those of 24 bytes and more,
  /// such as a line of a key, every part of 16 is taken out too.
  void add_secret(std::string_view secret);
  /// Every line of every file of `folder`, and of the folders in it, but of settings, certificates, pictures and warps.
  void add_secrets_of(const std::filesystem::path& folder);
  [[nodiscard]] std::string cleaned(std::string_view text) const;
  [[nodiscard]] std::size_t count() const { return secrets_.size(); }

 private:
  [[nodiscard]] std::string without_pieces(const std::string& text) const;

  std::vector<std::string> secrets_;                ///< The longest first.
  std::set<std::string, std::less<>> pieces_ = {};  ///< Of the long ones.
};

inline constexpr const char* kTakenOut = "[taken out]";

}  // namespace cyclorama
