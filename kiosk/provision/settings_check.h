// SPDX-License-Identifier: Apache-2.0
/// Checks whether every program of a museum, or of a render host, starts with a folder's settings.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "common/base/result.h"

namespace cyclorama::provision {

inline constexpr const char* kPinFile = "operator-pin";
inline constexpr const char* kPinGroup = "cyclorama-operator";  ///< Group that may read it.
inline constexpr const char* kOperatorFile = "operator.toml";
/// Lies in a folder that is checked while its projectors are still those of the image, without connectors; never kept.
inline constexpr const char* kAnyComputerFile = "any-computer";

/// A file that only one service may read.
struct SecretFile {
  std::filesystem::path name;  ///< Relative to the folder.
  std::string group;           ///< Group of the service that reads it: "cyclorama-tour".
};

/// Summary of the settings, and their problems. A value.
struct SettingsVerdict {
  std::string museum;
  std::vector<std::string> farm;
  int projectors = 0;
  std::string certificate_until;   ///< "2029-02-24"; empty: none.
  std::optional<std::string> pin;  ///< Plain text, to be hashed by the caller.
  std::vector<SecretFile> secrets;
  std::vector<std::string> problems;  ///< One sentence each, with file and remedy; empty: the settings are good.
  std::vector<std::string> remarks;   ///< Sentences on settings that may not do what was intended.
};

/// Owner of the settings; decides which files are required, and which programs read them.
enum class SettingsOf { kMuseum, kFarmHost };

struct SettingsCheck {
  /// Folder of cyclorama-display, cyclorama-tracker and cyclorama-calibrator (or cyclorama-farm and cyclorama-node),
  /// which check their own tables; empty: their tables are not checked.
  std::filesystem::path programs{};
  SettingsOf of = SettingsOf::kMuseum;
  /// The settings are for any computer, as the image's own are: projectors need neither a connector nor a serial.
  bool for_any_computer = false;
  std::filesystem::path sockets{"/sys/class/drm"};  ///< Folder in which the kernel lists the connectors.
};

/// Checks everything with the readers of the programs themselves, without stopping at the first mistake: site.toml
/// (required), installation.toml (required) with the meshes, warps and passwords it names, tracker.toml, wands,
/// calibrator.toml with the lenses of its cameras, operator.toml, care.toml, and the certificates and the attract picture that
/// site.toml names. A render host has farm.toml, node.toml or both, with certificates, tokens and scenes. Every file
/// that a setting names must lie in the folder. `folder` must contain only plain files (copy_folder()); sentences omit
/// its path.
[[nodiscard]] SettingsVerdict check_settings(const std::filesystem::path& folder, const SettingsCheck& how);

}  // namespace cyclorama::provision
