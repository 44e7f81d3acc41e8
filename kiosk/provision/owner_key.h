// SPDX-License-Identifier: Apache-2.0
/// The key that signs the USB sticks of a museum's owner (Ed25519, RFC 8032).
///
///   cyclorama sign-stick ──▶ stick: settings, SHA256SUMS of all, SHA256SUMS.sig, owner.pub
///   first stick ──▶ museum keeps owner.pub ──▶ later sticks bear a signature of that key
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "common/base/result.h"

namespace cyclorama::provision {

inline constexpr const char* kChecksumsFile = "SHA256SUMS";
inline constexpr const char* kSignatureFile = "SHA256SUMS.sig";
inline constexpr const char* kOwnerKeyFile = "owner.pub";

/// Returns whether `signature`, in base64, signs `text` by the private half of the public key, both as sign_stick()
/// writes them. Text that is no key or no signature gives false. Reentrant.
[[nodiscard]] bool is_signed_by(std::string_view text, std::string_view signature, std::string_view public_pem);

/// Signs all files of a stick's folder for the museum's owner, whose private key is the file `key`; makes that if it is
/// missing, readable by this user only. Errors: those of copy_folder(), since a museum would refuse such a stick;
/// kBadData if `key` is no Ed25519 key; kSystem if a file cannot be written.
Status sign_stick(const std::filesystem::path& folder, const std::filesystem::path& key);

}  // namespace cyclorama::provision
