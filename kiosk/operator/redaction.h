// SPDX-License-Identifier: Apache-2.0
/// Removes secrets from texts that leave the museum.
#pragma once

#include <filesystem>
#include <functional>
#include <set>
#include <string>
#include <string_view>
#include <vector>

namespace cyclorama::operations {

/// Removes the secrets of the settings in use: lines of private keys, words of password files, the PIN's hash. It also
/// removes whatever looks like a secret: blocks of PEM, and the values of settings whose name has one of the words pin,
/// password, secret, token, key, credential, auth or phrase (a setting whose whole name is "key" is kept, since it is a
/// path). A value.
class Redaction {
 public:
  /// Ignores texts shorter than 4 bytes, which would remove parts of ordinary words. If the secret has 24 bytes or
  /// more, such as a line of a key, every part of 16 bytes is removed, too.
  void add_secret(std::string_view secret);
  /// Adds every line of every file in `folder` and its subfolders, except settings, certificates, pictures and warps.
  void add_secrets_of(const std::filesystem::path& folder);
  [[nodiscard]] std::string cleaned(std::string_view text) const;
  [[nodiscard]] std::size_t count() const { return secrets_.size(); }

 private:
  [[nodiscard]] std::string without_pieces(const std::string& text) const;

  std::vector<std::string> secrets_;                ///< Sorted from long to short.
  std::set<std::string, std::less<>> pieces_ = {};  ///< Parts of the long secrets.
};

inline constexpr const char* kRedacted = "[taken out]";

}  // namespace cyclorama::operations
