// SPDX-License-Identifier: Apache-2.0
#include "kiosk/provision/certificate_renewal.h"

#include <fmt/format.h>

#include <algorithm>
#include <string>
#include <utility>

#include "common/base/file.h"
#include "kiosk/tour/session/tour_settings.h"

namespace cyclorama::provision {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kMaxPemBytes = std::size_t{64} * 1024;
constexpr FolderLimits kLimits{2, kMaxPemBytes, 2 * kMaxPemBytes};

struct NextPair {
  std::string certificate;
  std::string key;
};

/// Reads the pair by way of a copy, since its folder belongs to another user, who could put a link there.
Result<NextPair> read_pair(const fs::path& from, SettingsStore* store) {
  TRY_ASSIGN(const fs::path staging, store->begin());
  TRY(copy_folder(from, staging, kLimits));
  NextPair pair;
  TRY_ASSIGN(pair.certificate, read_text_file(staging / "certificate.crt", kMaxPemBytes));
  TRY_ASSIGN(pair.key, read_text_file(staging / "key.pem", kMaxPemBytes));
  return pair;
}

/// Writes a file of the copied settings anew, and notes it in their list.
Status exchange(const fs::path& folder, const fs::path& name, const std::string& text, std::vector<CopiedFile>* files) {
  const auto listed = std::ranges::find(*files, name.string(), &CopiedFile::name);
  if (listed == files->end()) {
    return Error(ErrorCode::kBadData, fmt::format("'{}' is not a file of the settings", name.string()));
  }
  TRY(write_file_atomically(folder / name, std::string_view(text)));
  TRY_ASSIGN(listed->sha256, sha256_of(text));
  listed->bytes = text.size();
  return Done{};
}

Status renew(const CertificateOrder& order, SettingsStore* store, ProvisioningReport* report) {
  TRY_ASSIGN(const tour::TourSettings tour, tour::read_tour_settings(store->settings() / "site.toml"));
  if (!tour.tls) return Error(ErrorCode::kNotFound, "the settings in use name no certificate");
  TRY_ASSIGN(const NextPair next, read_pair(order.from, store));
  TRY_ASSIGN(const fs::path folder, store->begin_with_those_in_use());
  std::vector<CopiedFile> files = store->contents();
  for (const auto& [file, text] : {std::pair(&tour.tls->certificate, &next.certificate), {&tour.tls->key, &next.key}}) {
    TRY(exchange(folder, file->lexically_normal().lexically_relative(store->settings()), *text, &files));
  }
  TRY_ASSIGN(SettingsVerdict verdict, order.sandbox ? check_sandboxed(folder, *order.sandbox)
                                                    : Result<SettingsVerdict>(check_settings(folder, order.check)));
  if (!verdict.problems.empty()) return Error(ErrorCode::kBadData, verdict.problems.front());
  if (verdict.certificate_until <= report->certificate_until) {
    return Error(ErrorCode::kBadData, fmt::format("the next certificate ends on {}, no later than the one in use",
                                                  verdict.certificate_until));
  }
  verdict.secrets.push_back({kPinFile, kPinGroup});
  TRY(store->commit_instead(std::move(files), verdict.secrets));
  report->certificate_until = verdict.certificate_until;
  report->in_use = store->in_use();
  return Done{};
}

}  // namespace

Status renew_certificate(const CertificateOrder& order, SettingsStore* store, ProvisioningReport* report) {
  Status done = renew(order, store, report);
  store->abandon();
  return done;
}

}  // namespace cyclorama::provision
