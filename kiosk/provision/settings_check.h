// SPDX-License-Identifier: Apache-2.0
/// Whether a folder's files are settings with which every program of a museum, or of a render host, starts.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "common/base/result.h"

namespace cyclorama {

inline constexpr const char* kPinFile = "operator-pin";
inline constexpr const char* kOperatorFile = "operator.toml";
inline constexpr const char* kChecksumsFile = "SHA256SUMS";

/// A file that only one service may read.
struct SecretFile {
  std::filesystem::path name;  ///< Within the folder.
  std::string group;           ///< Of the service that reads it: "cyclorama-tour".
};

/// A value. What is in the settings, and what is wrong with them.
struct SettingsVerdict {
  std::string museum;
  std::vector<std::string> farm;
  int projectors = 0;
  std::string certificate_until;   ///< "2029-02-24"; empty: none.
  std::optional<std::string> pin;  ///< In the clear, for the caller to hash.
  std::vector<SecretFile> secrets;
  std::vector<std::string> problems;  ///< One sentence each, with file and remedy; none: they are good.
  std::vector<std::string> remarks;   ///< They work, but not as one may have meant it.
};

/// Whose settings: what must be there, and who reads it.
enum class SettingsOf { kMuseum, kFarmHost };

struct SettingsCheck {
  /// Where cyclorama-display, cyclorama-tracker and cyclorama-calibrator (cyclorama-farm and cyclorama-node) are, which
  /// know their own tables; empty: those are not looked at.
  std::filesystem::path programs{};
  SettingsOf of = SettingsOf::kMuseum;
};

/// The readers of the programs themselves look at everything, and nothing stops at the first mistake: site.toml
/// (required), installation.toml (required) with the meshes, warps and passwords it names, tracker.toml, wands,
/// calibrator.toml with the lenses of its cameras, operator.toml, the certificates that site.toml names, its attract
/// picture. A render host has farm.toml, node.toml or both, with certificates, tokens and scenes. What a file names
/// must lie in the folder. `folder` must hold plain files alone (copy_folder()); its path is left out of the sentences.
[[nodiscard]] SettingsVerdict check_settings(const std::filesystem::path& folder, const SettingsCheck& how);

}  // namespace cyclorama
