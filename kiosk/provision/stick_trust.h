// SPDX-License-Identifier: Apache-2.0
/// Decides whether a USB stick may change a museum, before anything on it is parsed.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "common/base/result.h"
#include "kiosk/provision/folder_copy.h"
#include "kiosk/provision/settings_store.h"

namespace cyclorama::provision {

/// A copy of a stick's folder.
struct StickCopy {
  std::filesystem::path folder;
  const std::vector<CopiedFile>& files;
  std::string confirmed;  ///< Digest that the operator confirmed; empty: none.
};

struct StickTrust {
  bool is_trusted = false;
  std::string digest;           ///< Names this stick's content: the SHA-256 of all names and hashes.
  std::string reason;           ///< A sentence on why it is not trusted, with the remedy.
  std::string remark;           ///< What the owner should know although it is trusted; empty: nothing.
  std::string owner_pem;        ///< Key that signed the stick, by the stick itself; empty: it is not signed completely.
  bool may_name_owner = false;  ///< True if that key becomes the owner's.
};

/// A stick is trusted if one of these is so:
///   1. It is the first one.
///   2. It bears the owner's signature, over every file on it.
///   3. The operator confirmed exactly this content, on the page with the PIN.
///   4. There is neither an owner's key nor a PIN, so that nobody could answer for any stick.
/// By 1 and 3 it may name a new owner. Errors: kSystem if OpenSSL fails.
Result<StickTrust> trust_of(const StickCopy& stick, const SettingsStore& store);

/// Notes the owner, if this stick names one, and that the first stick was taken.
Status keep_owner(const StickTrust& trust, const SettingsStore& store);

}  // namespace cyclorama::provision
