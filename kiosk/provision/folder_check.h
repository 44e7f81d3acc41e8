// SPDX-License-Identifier: Apache-2.0
/// The common parts of checking a museum's and a render host's settings.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "common/wire/identity.h"
#include "common/wire/tls.h"
#include "kiosk/provision/settings_check.h"

namespace cyclorama::provision {

/// Collects the verdict on a folder. Its sentences omit the folder's path, which means nothing to their reader.
/// Thread-bound.
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
  /// Checks that a path from a setting leads to a file in this folder; `where` names the setting. Problems quote the
  /// path, unless it looks like a file's content.
  bool is_ours(const std::filesystem::path& path, const std::string& where);
  /// Does the same for a file that holds a password; nothing is quoted, since people write the password itself there.
  bool is_ours_unquoted(const std::filesystem::path& path, const std::string& where);
  void keep_secret(const std::filesystem::path& path, const std::string& group);
  /// Checks that the files exist, belong together, have not expired and are for `role`; `words` are the arguments of
  /// cyclorama-authority that make such certificates. Marks the key as readable by `group` only.
  void check_certificates(const TlsFiles& files, Role role, const std::string& where, const std::string& group,
                          const std::string& words);
  /// Runs a program that reads its settings as at its start, and records the problem that it reports. Does nothing if
  /// SettingsCheck::programs is empty, or after a problem.
  void ask(std::vector<std::string> command);

 private:
  bool is_within(const std::filesystem::path& path, const std::string& where, const std::string& name);
  [[nodiscard]] std::string without_folder(std::string text) const;

  const std::filesystem::path folder_;
  const SettingsCheck how_;
  SettingsVerdict verdict_{};
};

/// Does for a render host what check_settings() does for a museum: checks farm.toml, node.toml or both, the
/// certificates and tokens that they name and, on the coordinator, the scenes beside them.
[[nodiscard]] SettingsVerdict check_farm_host(const std::filesystem::path& folder, const SettingsCheck& how);

}  // namespace cyclorama::provision
