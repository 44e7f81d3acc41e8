// SPDX-License-Identifier: Apache-2.0
#include "kiosk/operator/support_bundle.h"

#include <fmt/format.h>
#include <sys/utsname.h>
#include <zip.h>

#include <map>
#include <memory>
#include <system_error>

#include "common/base/file.h"
#include "common/process/child.h"
#include "kiosk/operator/redaction.h"

namespace cyclorama::operations {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kMaxFileBytes = 1 << 20;
constexpr std::size_t kMaxFiles = 100;
constexpr std::size_t kMaxJournalRead = std::size_t{64} << 20;

using Members = std::map<std::string, std::string>;

/// Returns the archive of the texts, which must outlive the call.
Result<std::string> zipped(const Members& members) {
  const Error failed(ErrorCode::kSystem, "the support bundle cannot be made; is there enough memory?");
  zip_source_t* const whole = zip_source_buffer_create(nullptr, 0, 0, nullptr);
  if (whole == nullptr) return failed;
  zip_t* const archive = zip_open_from_source(whole, ZIP_TRUNCATE, nullptr);
  if (archive == nullptr) {
    zip_source_free(whole);
    return failed;
  }
  zip_source_keep(whole);  // Closing the archive releases the source, but what was written must still be read.
  const std::unique_ptr<zip_source_t, void (*)(zip_source_t*)> owner(whole, zip_source_free);
  for (const auto& [name, text] : members) {
    zip_source_t* const source = zip_source_buffer(archive, text.data(), text.size(), 0);
    if (source == nullptr || zip_file_add(archive, name.c_str(), source, ZIP_FL_ENC_UTF_8) < 0) {
      zip_source_free(source);
      zip_discard(archive);
      return failed;
    }
  }
  if (zip_close(archive) != 0) {
    zip_discard(archive);
    return failed;
  }
  if (zip_source_open(whole) != 0) return failed;
  std::string bytes;
  zip_stat_t info;
  zip_stat_init(&info);
  if (zip_source_stat(whole, &info) == 0 && (info.valid & ZIP_STAT_SIZE) != 0) bytes.resize(info.size);
  const zip_int64_t read = zip_source_read(whole, bytes.data(), bytes.size());
  zip_source_close(whole);
  if (bytes.empty() || read != static_cast<zip_int64_t>(bytes.size())) return failed;
  return bytes;
}

void add_files(const fs::path& folder, const std::string& within, const Redaction& redaction, Members* members,
               std::string* problems) {
  std::error_code failed;
  for (fs::directory_iterator entry(folder, failed), end; !failed && entry != end; entry.increment(failed)) {
    const std::string extension = entry->path().extension().string();
    if (extension != ".toml" && extension != ".json") continue;
    if (members->size() >= kMaxFiles) return;
    const std::string name = within + entry->path().filename().string();
    const auto text = read_text_file(entry->path(), kMaxFileBytes);
    if (text) {
      (*members)[name] = redaction.cleaned(*text);
    } else {
      *problems += fmt::format("{}: {}\n", name, text.error().message());
    }
  }
  if (failed) *problems += fmt::format("{}: {}\n", within, failed.message());
}

std::string versions() {
  std::string text = fmt::format("cyclorama {}\n", CYCLORAMA_VERSION);
  utsname kernel{};
  if (::uname(&kernel) == 0) text += fmt::format("{} {} {}\n", kernel.sysname, kernel.release, kernel.machine);
  if (const auto system = read_text_file("/usr/lib/os-release", kMaxFileBytes)) text += *system;
  return text;
}

void add_journal(const SupportOrder& order, const Redaction& redaction, Members* members, std::string* problems) {
  const auto journal = run_child(order.journal, {order.longest, kMaxJournalRead});
  if (!journal) {
    *problems += fmt::format("journal.txt: {}\n", journal.error().message());
    return;
  }
  if (journal->exit_code != 0) *problems += fmt::format("journal.txt: it ended with {}\n", journal->exit_code);
  std::string text = journal->output;
  // Redacts before truncation, since half a secret would not be recognised.
  text = redaction.cleaned(text);
  if (text.size() > order.max_journal_bytes) {
    const std::size_t from = text.find('\n', text.size() - order.max_journal_bytes);
    text.erase(0, from == std::string::npos ? text.size() - order.max_journal_bytes : from + 1);
    text.insert(0, "[older lines were left out]\n");
  }
  (*members)["journal.txt"] = std::move(text);
}

}  // namespace

Result<std::string> support_bundle(const SupportOrder& order, const std::string& status_json,
                                   const std::string& checks_json) {
  Redaction redaction;
  redaction.add_secrets_of(order.museum.settings());
  Members members;
  std::string problems;
  members["status.json"] = redaction.cleaned(status_json);
  members["checks.json"] = redaction.cleaned(checks_json);
  members["versions.txt"] = redaction.cleaned(versions());
  add_files(order.museum.settings(), "settings/", redaction, &members, &problems);
  const fs::path lenses = order.museum.settings() / "cameras";
  std::error_code ignored;
  if (fs::is_directory(lenses, ignored)) add_files(lenses, "settings/cameras/", redaction, &members, &problems);
  add_files(order.museum.root, "state/", redaction, &members, &problems);
  add_journal(order, redaction, &members, &problems);
  if (!problems.empty()) members["problems.txt"] = redaction.cleaned(problems);
  return zipped(members);
}

}  // namespace cyclorama::operations
