// SPDX-License-Identifier: Apache-2.0
/// What the checks of a museum's and of a render host's settings do alike.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "common/wire/identity.h"
#include "common/wire/tls.h"
#include "kiosk/provision/settings_check.h"

namespace cyclorama {

/// A folder's verdict while it is made. Sentences come without the folder's path: where it lies for now is nothing to
/// the reader. Thread-bound.
class FolderCheck {
 public:
  FolderCheck(const std::filesystem::path& folder, const SettingsCheck& how)
      : folder_(folder.lexically_normal()), how_(how) {}

  [[nodiscard]] const std::filesystem::path& folder() const { return folder_; }
  [[nodiscard]] std::filesystem::path in(const std::string& name) const { return folder_ / name; }
  [[nodiscard]] bool has(const std::string& name) const;
  SettingsVerdict& verdict() { return verdict_; }

  void problem(const std::string& text);
  void remark(const std::string& text);
  /// That a path from a setting leads to a file of this folder; `where` names the setting. Problems quote the path,
  /// but for what looks like a file's content.
  bool is_ours(const std::filesystem::path& path, const std::string& where);
  /// The same for a file that holds a password; nothing is quoted, as people write the password itself there.
  bool is_ours_unquoted(const std::filesystem::path& path, const std::string& where);
  void keep_secret(const std::filesystem::path& path, const std::string& group);
  /// That they are here, belong together, have not run out and are such a one's, for which `words` of
  /// cyclorama-authority make them. The key is `group`'s alone.
  void check_certificates(const TlsFiles& files, Role role, const std::string& where, const std::string& group,
                          const std::string& words);
  /// A program reads its settings as it would at its start, and says what it makes of them; without programs, or after
  /// a problem, it is not asked.
  void ask(std::vector<std::string> command);

 private:
  bool is_within(const std::filesystem::path& path, const std::string& where, const std::string& name);
  [[nodiscard]] std::string without_folder(std::string text) const;

  const std::filesystem::path folder_;
  const SettingsCheck how_;
  SettingsVerdict verdict_{};
};

/// check_settings() of a render host: farm.toml, node.toml or both, the certificates and tokens that they name, scenes
/// on the head that lie beside them.
[[nodiscard]] SettingsVerdict check_farm_host(const std::filesystem::path& folder, const SettingsCheck& how);

}  // namespace cyclorama
