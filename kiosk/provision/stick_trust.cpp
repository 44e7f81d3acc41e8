// SPDX-License-Identifier: Apache-2.0
#include "kiosk/provision/stick_trust.h"

#include <algorithm>
#include <optional>
#include <system_error>

#include "common/base/file.h"
#include "kiosk/provision/owner_key.h"
#include "kiosk/provision/settings_check.h"

namespace cyclorama::provision {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kMaxStickTextBytes = std::size_t{256} * 1024;

std::string text_in(const fs::path& path) {
  auto text = read_text_file(path, kMaxStickTextBytes);
  return text ? *std::move(text) : "";
}

bool exists_or_unknown(const fs::path& path) {
  std::error_code unknown;
  return fs::exists(path, unknown) || unknown;
}

/// True if the signed list names every file of the stick, with its hash; the list and its signature cannot name
/// themselves.
bool lists_all(std::string_view sums, const std::vector<CopiedFile>& files) {
  const auto listed = parse_checksums(sums);
  return listed && std::all_of(files.begin(), files.end(), [&](const CopiedFile& file) {
           if (file.name == kChecksumsFile || file.name == kSignatureFile) return true;
           return std::any_of(listed->begin(), listed->end(), [&](const CopiedFile& one) {
             return one.name == file.name && one.sha256 == file.sha256;
           });
         });
}

}  // namespace

Result<StickTrust> trust_of(const StickCopy& stick, const SettingsStore& store) {
  StickTrust trust;
  TRY_ASSIGN(trust.digest, sha256_of(checksums_text(stick.files)));
  const std::string sums = text_in(stick.folder / kChecksumsFile);
  const std::string signature = text_in(stick.folder / kSignatureFile);
  const bool is_complete = lists_all(sums, stick.files);
  const std::string named = text_in(stick.folder / kOwnerKeyFile);
  if (is_complete && is_signed_by(sums, signature, named)) trust.owner_pem = named;

  const bool is_first = !exists_or_unknown(store.owner());
  const std::string owner = text_in(store.owner());
  const bool is_confirmed = !stick.confirmed.empty() && stick.confirmed == trust.digest;
  trust.may_name_owner = is_first || is_confirmed;
  trust.is_trusted =
      is_first || is_confirmed || (!owner.empty() && is_complete && is_signed_by(sums, signature, owner));
  if (trust.is_trusted) return trust;
  if (owner.empty() && !exists_or_unknown(store.settings() / kPinFile)) {
    trust.is_trusted = true;
    trust.remark =
        "this museum takes anybody's stick, since it knows neither its owner's key nor a PIN: sign the stick with "
        "'cyclorama sign-stick', or put an operator.toml with a PIN on it";
    trust.may_name_owner = true;
    return trust;
  }
  trust.reason =
      owner.empty() ? "nobody has answered for this stick: confirm it on the operator page"
      : signature.empty()
          ? "this stick is not signed: sign it with 'cyclorama sign-stick', or confirm it on the operator page"
      : is_complete ? "this stick is signed with another key than the owner's: confirm it on the operator page"
                    : "this stick was changed after it was signed: sign it again with 'cyclorama sign-stick', or "
                      "confirm it on the operator page";
  return trust;
}

Status keep_owner(const StickTrust& trust, const SettingsStore& store) {
  if (!trust.may_name_owner) return Done{};
  // A confirmed stick without a key leaves the owner's key in place.
  if (trust.owner_pem.empty() && exists_or_unknown(store.owner())) return Done{};
  return write_file_atomically(store.owner(), std::string_view(trust.owner_pem));
}

}  // namespace cyclorama::provision
