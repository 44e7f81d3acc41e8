// SPDX-License-Identifier: Apache-2.0
/// Files of one version of an appliance's image, as listed in the SHA256SUMS that image/build writes and signs.
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
inline constexpr std::size_t kMaxUpdateTextBytes = 16 * 1024;  ///< Limit for SHA256SUMS and for its signature.

struct UpdateFile {
  std::string name;    ///< Letters, digits, '.', '-', '_': a file name without a path.
  std::string sha256;  ///< 64 lower-case hexadecimal digits.
};

/// A value. There is one kernel image, one root and one file of root's hashes, all of one version.
struct UpdateManifest {
  std::string version;
  std::array<UpdateFile, 3> files;  ///< In this order: kernel image, root, root's hashes.
};

/// Errors: kBadData, with the line, if the text has another form, belongs to another image, or does not have exactly
/// one file of each kind.
Result<UpdateManifest> parse_update_manifest(std::string_view text, std::string_view image);

/// True for 1 to 64 letters, digits and '-', which can be a folder's name.
[[nodiscard]] bool is_image_name(std::string_view name);
/// True for numbers separated by dots, at most 64 characters: "0.1.0.202611230346".
[[nodiscard]] bool is_image_version(std::string_view version);
/// Compares number by number; a missing number is less than 0. Precondition: both are versions.
[[nodiscard]] bool is_newer(std::string_view version, std::string_view than);

}  // namespace cyclorama
