// SPDX-License-Identifier: Apache-2.0
/// What a version of an appliance's image consists of: the SHA256SUMS that image/build writes and signs.
///
///   HASH  cyclorama-museum_0.2.0.202612010300.efi
///   HASH  cyclorama-museum_0.2.0.202612010300_UUID.root.raw
///   HASH  cyclorama-museum_0.2.0.202612010300_UUID.verity.raw
#pragma once

#include <array>
#include <string>
#include <string_view>

#include "common/base/result.h"

namespace cyclorama {

inline constexpr const char* kUpdateSums = "SHA256SUMS";
inline constexpr const char* kUpdateSignature = "SHA256SUMS.sig";
inline constexpr std::size_t kMaxUpdateTextBytes = 16 * 1024;  ///< Of either.

struct UpdateFile {
  std::string name;    ///< Letters, digits, '.', '-', '_': a file's name and nothing else.
  std::string sha256;  ///< 64 hexadecimal digits in lower case.
};

/// A value. The kernel image, root and its hashes: one of each, of one version.
struct UpdateManifest {
  std::string version;
  std::array<UpdateFile, 3> files;  ///< Kernel image, root, root's hashes.
};

/// kBadData  not such lines, another image's, or not one file of each kind; says which line.
Result<UpdateManifest> parse_update_manifest(std::string_view text, std::string_view image);

/// Letters, digits and '-', at most 64, not empty: a folder's name too.
[[nodiscard]] bool is_image_name(std::string_view name);
/// Numbers with dots between, at most 64 characters: "0.1.0.202611230346".
[[nodiscard]] bool is_image_version(std::string_view version);
/// Number by number; what is missing is less than 0. Precondition: both are versions.
[[nodiscard]] bool is_newer(std::string_view version, std::string_view than);

}  // namespace cyclorama
