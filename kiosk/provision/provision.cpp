// SPDX-License-Identifier: Apache-2.0
#include "kiosk/provision/provision.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cstddef>
#include <span>
#include <system_error>

#include "common/base/file.h"
#include "kiosk/provision/owner_key.h"
#include "kiosk/provision/pin.h"
#include "kiosk/provision/stick_trust.h"

namespace cyclorama::provision {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kMaxTextBytes = 256 * 1024;

const CopiedFile* find(const std::vector<CopiedFile>& files, std::string_view name) {
  const auto found =
      std::find_if(files.begin(), files.end(), [&](const CopiedFile& file) { return file.name == name; });
  return found == files.end() ? nullptr : &*found;
}

void forget(const fs::path& folder, const char* name, std::vector<CopiedFile>* files) {
  std::error_code ignored;
  fs::remove(folder / name, ignored);
  std::erase_if(*files, [&](const CopiedFile& file) { return file.name == name; });
}

/// Compares the files with SHA256SUMS, if the USB stick has it.
void compare_checksums(const fs::path& folder, const std::vector<CopiedFile>& files,
                       std::vector<std::string>* problems) {
  if (find(files, kChecksumsFile) == nullptr) return;
  const auto text = read_text_file(folder / kChecksumsFile, kMaxTextBytes);
  const auto wanted = text ? parse_checksums(*text) : Result<std::vector<CopiedFile>>(text.error());
  if (!wanted) return problems->push_back(fmt::format("{}: {}", kChecksumsFile, wanted.error().message()));
  for (const CopiedFile& file : *wanted) {
    const CopiedFile* const copied = find(files, file.name);
    if (copied == nullptr) {
      problems->push_back(
          fmt::format("{} names '{}', which is not there; copy the folder again", kChecksumsFile, file.name));
    } else if (copied->sha256 != file.sha256) {
      problems->push_back(
          fmt::format("'{}' is not the file that {} names; copy the folder again", file.name, kChecksumsFile));
    }
  }
}

/// Replaces the PIN by its hash. The same PIN keeps its hash, so that the same USB stick changes nothing.
Status keep_pin(const fs::path& folder, const SettingsStore& store, const std::optional<std::string>& pin,
                std::vector<CopiedFile>* files) {
  forget(folder, kOperatorFile, files);
  if (!pin) return Done{};
  const auto before = read_text_file(store.settings() / kPinFile, kMaxTextBytes);
  const auto same = before ? is_pin(*pin, *before) : Result<bool>(false);
  std::string hash;
  if (same && *same) {
    hash = *before;
  } else {
    TRY_ASSIGN(hash, hashed_pin(*pin));
    hash += "\n";
  }
  TRY(write_file_atomically(folder / kPinFile, std::string_view(hash)));
  TRY_ASSIGN(std::string sha256, sha256_of(hash));
  files->push_back({kPinFile, hash.size(), std::move(sha256)});
  return Done{};
}

bool are_the_same(std::vector<CopiedFile> a, std::vector<CopiedFile> b) {
  const auto by_name = [](const CopiedFile& x, const CopiedFile& y) { return x.name < y.name; };
  std::sort(a.begin(), a.end(), by_name);
  std::sort(b.begin(), b.end(), by_name);
  return std::equal(a.begin(), a.end(), b.begin(), b.end(),
                    [](const CopiedFile& x, const CopiedFile& y) { return x.name == y.name && x.sha256 == y.sha256; });
}

/// Adds the files in use that an offer leaves as they are.
Status add_files_in_use(const fs::path& folder, const SettingsStore& store, const FolderLimits& limits,
                        std::vector<CopiedFile>* files) {
  for (const CopiedFile& file : store.contents()) {
    if (find(*files, file.name) != nullptr) continue;
    TRY_ASSIGN(const std::vector<std::byte> bytes, read_file(store.settings() / file.name, limits.max_file_bytes));
    std::error_code failed;
    fs::create_directories((folder / file.name).parent_path(), failed);
    TRY(write_file_atomically(folder / file.name, std::span<const std::byte>(bytes)));
    files->push_back(file);
  }
  return Done{};
}

/// Returns whether the file, which an offer brought, is a PIN's hash.
bool is_hash_of_a_pin(const fs::path& file) {
  const auto text = read_text_file(file, kMaxTextBytes);
  return text && is_pin("", *text);
}

/// Mistakes in the user's files become problems in the report; only failures of this computer are errors.
bool is_of_this_computer(const Error& error) { return error.code() == ErrorCode::kSystem; }

Status look_at(const ProvisionOrder& order, const fs::path& folder, SettingsStore* store, ProvisioningReport* report) {
  auto copied = copy_folder(order.from, folder, order.limits);
  if (!copied && is_of_this_computer(copied.error())) return std::move(copied).error();
  if (!copied) {
    report->problems.push_back(copied.error().message());
    return Done{};
  }
  for (const std::string& name : copied->left_out) report->remarks.push_back(fmt::format("'{}' was left out", name));
  if (find(copied->files, kPinFile) != nullptr && !(order.is_over && is_hash_of_a_pin(folder / kPinFile))) {
    report->problems.push_back(
        fmt::format("'{}' is this computer's own; write the PIN into {}", kPinFile, kOperatorFile));
  }
  forget(folder, kAnyComputerFile, &copied->files);
  if (order.is_over) {
    // Projectors that an offer leaves as they are were accepted before, also without connectors.
    const bool has_projectors = find(copied->files, "installation.toml") != nullptr;
    TRY(add_files_in_use(folder, *store, order.limits, &copied->files));
    if (!has_projectors) TRY(write_file_atomically(folder / kAnyComputerFile, std::string_view()));
  }
  TRY_ASSIGN(StickTrust trust, trust_of({folder, copied->files, order.confirmed}, *store));
  if (order.is_stick && !trust.is_trusted) {
    // Nothing of the stick is parsed before somebody has answered for it.
    report->verdict = ProvisioningVerdict::kUnconfirmed;
    report->digest = trust.digest;
    report->problems.push_back(std::move(trust.reason));
    return Done{};
  }
  compare_checksums(folder, copied->files, &report->problems);
  if (order.is_stick && !trust.remark.empty()) report->remarks.push_back(trust.remark);
  TRY_ASSIGN(SettingsVerdict verdict, order.sandbox ? check_sandboxed(folder, *order.sandbox)
                                                    : Result<SettingsVerdict>(check_settings(folder, order.check)));
  report->museum = verdict.museum;
  report->farm = verdict.farm;
  report->projectors = verdict.projectors;
  report->certificate_until = verdict.certificate_until;
  report->has_pin = verdict.pin.has_value() || find(copied->files, kPinFile) != nullptr;
  report->problems.insert(report->problems.end(), verdict.problems.begin(), verdict.problems.end());
  report->remarks.insert(report->remarks.end(), verdict.remarks.begin(), verdict.remarks.end());
  if (!report->problems.empty()) return Done{};
  for (const char* const name : {kChecksumsFile, kSignatureFile, kOwnerKeyFile, kAnyComputerFile})
    forget(folder, name, &copied->files);
  TRY(keep_pin(folder, *store, verdict.pin, &copied->files));
  verdict.secrets.push_back({kPinFile, kPinGroup});
  if (are_the_same(copied->files, store->contents())) {
    report->verdict = ProvisioningVerdict::kUnchanged;
  } else {
    if (!order.only_check) TRY(store->commit(std::move(copied->files), verdict.secrets));
    report->verdict = ProvisioningVerdict::kInstalled;
  }
  if (order.only_check) return Done{};
  // The owner of the PIN has answered for these settings, so the next stick is not the first one.
  if (order.is_over && !fs::exists(store->owner())) return write_file_atomically(store->owner(), std::string_view());
  return order.is_stick ? keep_owner(trust, *store) : Done{};
}

}  // namespace

Result<ProvisioningReport> provision(const ProvisionOrder& order, SettingsStore* store) {
  ProvisioningReport report;
  report.at = order.at;
  report.source = order.from.string();
  TRY_ASSIGN(const fs::path folder, store->begin());
  const Status done = look_at(order, folder, store, &report);
  store->abandon();
  if (!done) return done.error();
  report.in_use = store->in_use();
  return report;
}

Result<ProvisioningReport> restore_settings(const std::string& at, SettingsStore* store, SettingsOf of) {
  const Status done = store->restore();
  if (!done) store->abandon();
  TRY(Status(done));
  ProvisioningReport report;
  report.at = at;
  report.verdict = ProvisioningVerdict::kRestored;
  report.in_use = store->in_use();
  const SettingsVerdict verdict = check_settings(store->settings(), {{}, of});
  report.museum = verdict.museum;
  report.farm = verdict.farm;
  report.projectors = verdict.projectors;
  report.certificate_until = verdict.certificate_until;
  report.has_pin = find(store->contents(), kPinFile) != nullptr;
  // The settings are in use in spite of their problems.
  report.remarks = verdict.problems;
  return report;
}

}  // namespace cyclorama::provision
