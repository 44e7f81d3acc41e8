// SPDX-License-Identifier: Apache-2.0
#include "kiosk/provision/settings_store.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <grp.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <system_error>
#include <utility>

#include "common/base/file.h"
#include "common/base/text.h"

namespace cyclorama::provision {
namespace {

namespace fs = std::filesystem;

constexpr const char* kPreviousNote = ".previous";
constexpr const char* kContentsNote = ".contents";
constexpr std::size_t kDigits = 6;
constexpr std::size_t kMaxNoteBytes = 256 * 1024;

bool is_number(std::string_view name) {
  return name.size() == kDigits && std::all_of(name.begin(), name.end(), [](char c) { return c >= '0' && c <= '9'; });
}

Status sync_folder(const fs::path& path) {
  const UniqueFd fd(::open(path.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC));
  if (!fd.is_open() || ::fsync(fd.get()) != 0) return Error::from_errno(fmt::format("writing '{}'", path.string()));
  return Done{};
}

/// Makes a folder with exactly this mode, regardless of the umask.
Status make_folder(const fs::path& path, mode_t mode) {
  if (::mkdir(path.c_str(), mode) == 0 ? ::chmod(path.c_str(), mode) == 0 : errno == EEXIST) return Done{};
  return Error::from_errno(fmt::format("making the folder '{}'", path.string()));
}

Status remove_tree(const fs::path& path) {
  std::error_code failed;
  fs::remove_all(path, failed);
  if (failed) return Error(ErrorCode::kSystem, fmt::format("removing '{}': {}", path.string(), failed.message()));
  return Done{};
}

Status move(const fs::path& from, const fs::path& to) {
  if (::rename(from.c_str(), to.c_str()) == 0) return Done{};
  return Error::from_errno(fmt::format("renaming '{}' to '{}'", from.string(), to.string()));
}

/// Makes a file readable by every service or, if it is a secret, by one group; by this user only if that group is
/// unknown or the file cannot be given to it.
Status protect(const fs::path& file, const std::optional<std::string>& group) {
  mode_t mode = 0644;
  if (group) {
    const ::group* const known = ::getgrnam(group->c_str());
    mode = known != nullptr && ::chown(file.c_str(), static_cast<uid_t>(-1), known->gr_gid) == 0 ? 0640 : 0600;
  }
  if (::chmod(file.c_str(), mode) == 0) return Done{};
  return Error::from_errno(fmt::format("protecting '{}'", file.string()));
}

Status protect_all(const fs::path& folder, const std::vector<CopiedFile>& files,
                   const std::vector<SecretFile>& secrets) {
  for (const CopiedFile& file : files) {
    const auto secret =
        std::find_if(secrets.begin(), secrets.end(), [&](const SecretFile& s) { return s.name == file.name; });
    TRY(protect(folder / file.name, secret == secrets.end() ? std::nullopt : std::optional(secret->group)));
    const fs::path inner = (folder / file.name).parent_path();
    if (inner != folder && ::chmod(inner.c_str(), 0755) != 0) {
      return Error::from_errno(fmt::format("protecting '{}'", inner.string()));
    }
    if (inner != folder) TRY(sync_folder(inner));
  }
  if (::chmod(folder.c_str(), 0755) != 0) return Error::from_errno(fmt::format("protecting '{}'", folder.string()));
  return Done{};
}

}  // namespace

SettingsStore::SettingsStore(fs::path root, UniqueFd lock, StepHook hook)
    : root_(std::move(root)), lock_(std::move(lock)), hook_(std::move(hook)) {}

Result<SettingsStore> SettingsStore::open(const fs::path& root, StepHook hook) {
  TRY(make_folder(root, 0755));
  TRY(make_folder(root / "generations", 0755));
  UniqueFd lock(::open((root / ".lock").c_str(), O_RDWR | O_CREAT | O_CLOEXEC | O_NOFOLLOW, 0600));
  if (!lock.is_open()) return Error::from_errno(fmt::format("opening '{}'", root.string()));
  if (::flock(lock.get(), LOCK_EX | LOCK_NB) != 0) {
    return Error(ErrorCode::kBusy, fmt::format("another program changes '{}'; try again", root.string()));
  }
  return SettingsStore(root, std::move(lock), std::move(hook));
}

void SettingsStore::step(std::string_view name) const {
  if (hook_) hook_(name);
}

fs::path SettingsStore::generation(const std::string& number) const { return root_ / "generations" / number; }

std::string SettingsStore::in_use() const {
  std::error_code failed;
  const std::string number = fs::read_symlink(settings(), failed).filename().string();
  return !failed && is_number(number) && fs::is_directory(generation(number), failed) ? number : "";
}

std::string SettingsStore::previous_of(const std::string& number) const {
  if (number.empty()) return "";
  const auto text = read_text_file(generation(number) / kPreviousNote, kMaxNoteBytes);
  std::error_code failed;
  return text && is_number(*text) && fs::is_directory(generation(*text), failed) ? *text : "";
}

std::string SettingsStore::next_number() const {
  long long max = 0;
  std::error_code failed;
  for (fs::directory_iterator entry(root_ / "generations", failed), end; !failed && entry != end;
       entry.increment(failed)) {
    const std::string name = entry->path().filename().string();
    if (is_number(name)) max = std::max(max, parse_integer(name).value_or(0));
  }
  return fmt::format("{:0{}}", (max + 1) % 1'000'000, kDigits);
}

std::vector<CopiedFile> SettingsStore::contents() const {
  const auto text = read_text_file(settings() / kContentsNote, kMaxNoteBytes);
  if (!text) return {};
  auto files = parse_checksums(*text);
  return files ? *std::move(files) : std::vector<CopiedFile>{};
}

Result<fs::path> SettingsStore::begin() {
  step("remove what is left");
  TRY(remove_tree(staging()));
  prune();
  step("make the folder");
  TRY(make_folder(staging(), 0700));
  return staging();
}

void SettingsStore::abandon() { static_cast<void>(remove_tree(staging())); }

Status SettingsStore::write_note(const char* name, std::string_view text) const {
  step(name);
  return write_file_atomically(staging() / name, text);
}

Status SettingsStore::switch_to(const std::string& number) {
  const fs::path link = root_ / "settings.new";
  step("make the link");
  if (::unlink(link.c_str()) != 0 && errno != ENOENT) return Error::from_errno("removing an old link");
  if (::symlink(("generations/" + number).c_str(), link.c_str()) != 0) {
    return Error::from_errno(fmt::format("making '{}'", link.string()));
  }
  step("take into use");
  TRY(move(link, settings()));
  step("flush the link");
  return sync_folder(root_);
}

Status SettingsStore::commit(std::vector<CopiedFile> files, const std::vector<SecretFile>& secrets) {
  return commit_after(in_use(), std::move(files), secrets);
}

Status SettingsStore::commit_instead(std::vector<CopiedFile> files, const std::vector<SecretFile>& secrets) {
  return commit_after(previous_of(in_use()), std::move(files), secrets);
}

Status SettingsStore::commit_after(const std::string& previous, std::vector<CopiedFile> files,
                                   const std::vector<SecretFile>& secrets) {
  std::sort(files.begin(), files.end(), [](const CopiedFile& a, const CopiedFile& b) { return a.name < b.name; });
  const std::string number = next_number();
  step("protect");
  TRY(protect_all(staging(), files, secrets));
  TRY(write_note(kPreviousNote, previous));
  TRY(write_note(kContentsNote, checksums_text(files)));
  TRY(sync_folder(staging()));
  step("name the generation");
  TRY(move(staging(), generation(number)));
  step("flush the name");
  TRY(sync_folder(root_ / "generations"));
  TRY(switch_to(number));
  step("remove the old");
  prune();
  return Done{};
}

/// Copies a generation into the staging folder, with modes and groups.
Status SettingsStore::copy(const std::string& number) const {
  const fs::path folder = staging();
  std::error_code failed;
  step("copy");
  fs::copy(generation(number), folder, fs::copy_options::recursive, failed);
  if (failed) return Error(ErrorCode::kSystem, fmt::format("copying settings: {}", failed.message()));
  for (fs::recursive_directory_iterator entry(folder, failed), end; !failed && entry != end; entry.increment(failed)) {
    struct stat info {};
    const fs::path from = generation(number) / entry->path().lexically_relative(folder);
    const UniqueFd fd(::open(entry->path().c_str(), O_RDONLY | O_NOFOLLOW | O_CLOEXEC));
    if (!fd.is_open() || ::stat(from.c_str(), &info) != 0 || ::fchmod(fd.get(), info.st_mode & 07777) != 0 ||
        (info.st_gid != ::getegid() && ::fchown(fd.get(), static_cast<uid_t>(-1), info.st_gid) != 0) ||
        ::fsync(fd.get()) != 0) {
      return Error::from_errno(fmt::format("copying '{}'", entry->path().string()));
    }
  }
  return Done{};
}

Result<fs::path> SettingsStore::begin_with_those_in_use() {
  const std::string now = in_use();
  if (now.empty()) return Error(ErrorCode::kNotFound, "there are no settings in use");
  TRY_ASSIGN(fs::path folder, begin());
  TRY(copy(now));
  return folder;
}

Status SettingsStore::restore() {
  const std::string previous = previous_of(in_use());
  if (previous.empty()) return Error(ErrorCode::kNotFound, "there are no previous settings");
  TRY_ASSIGN(const fs::path folder, begin());
  // The generation is copied, so that the one in use is always the newest, and its predecessor the previous one.
  TRY(copy(previous));
  if (::chmod(folder.c_str(), 0755) != 0) return Error::from_errno("protecting the previous settings");
  const std::string number = next_number();
  TRY(write_note(kPreviousNote, in_use()));
  TRY(sync_folder(folder));
  step("name the generation");
  TRY(move(folder, generation(number)));
  step("flush the name");
  TRY(sync_folder(root_ / "generations"));
  TRY(switch_to(number));
  prune();
  return Done{};
}

void SettingsStore::prune() const {
  const std::string now = in_use();
  const std::string before = previous_of(now);
  std::vector<fs::path> old;
  std::error_code failed;
  for (fs::directory_iterator entry(root_ / "generations", failed), end; !failed && entry != end;
       entry.increment(failed)) {
    const std::string name = entry->path().filename().string();
    if (name != now && name != before) old.push_back(entry->path());
  }
  for (const fs::path& path : old) static_cast<void>(remove_tree(path));
}

}  // namespace cyclorama::provision
