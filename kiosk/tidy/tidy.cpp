// SPDX-License-Identifier: Apache-2.0
#include "kiosk/tidy/tidy.h"

#include <fmt/format.h>
#include <sys/stat.h>
#include <sys/statvfs.h>

#include <algorithm>
#include <set>
#include <system_error>

namespace cyclorama {
namespace {

namespace fs = std::filesystem;

/// What it takes on the disk, and when anything in it last changed.
void measure(const fs::path& path, TidyEntry* ret) {
  struct stat info {};
  if (::lstat(path.c_str(), &info) != 0) return;
  constexpr std::uint64_t kBlock = 512;  // stat(2) counts in these.
  ret->bytes += kBlock * static_cast<std::uint64_t>(info.st_blocks);
  ret->changed_s = std::max(ret->changed_s, std::int64_t{info.st_mtim.tv_sec});
  if (!S_ISDIR(info.st_mode)) return;
  std::error_code failed;
  for (fs::directory_iterator entry(path, failed), end; !failed && entry != end; entry.increment(failed))
    measure(entry->path(), ret);
}

/// The name of the entry of `folder` that a link leads to; empty: it leads elsewhere.
std::string entry_of_link(const fs::path& link, const fs::path& folder) {
  std::error_code failed;
  const fs::path to = fs::read_symlink(link, failed);
  if (failed) return "";
  const fs::path within = (link.parent_path() / to).lexically_normal().lexically_relative(folder.lexically_normal());
  return within.empty() || *within.begin() == ".." || *within.begin() == "." ? "" : within.begin()->string();
}

}  // namespace

std::vector<TidyEntry> too_much(std::vector<TidyEntry> entries, const TidyLimits& limits, std::uint64_t free_bytes) {
  std::sort(entries.begin(), entries.end(), [](const TidyEntry& a, const TidyEntry& b) {
    return a.changed_s != b.changed_s ? a.changed_s > b.changed_s : a.name > b.name;
  });
  std::uint64_t all = 0;
  for (const TidyEntry& entry : entries) all += entry.bytes;
  std::vector<TidyEntry> may_go;
  std::size_t kept = 0;
  for (const TidyEntry& entry : entries) {
    if (entry.is_in_use) continue;
    if (kept < limits.keep) {
      ++kept;
    } else {
      may_go.push_back(entry);
    }
  }
  std::vector<TidyEntry> go;
  while (!may_go.empty() && ((limits.most_bytes > 0 && all > limits.most_bytes) || free_bytes < limits.least_free)) {
    all -= may_go.back().bytes;
    free_bytes += may_go.back().bytes;
    go.push_back(std::move(may_go.back()));
    may_go.pop_back();
  }
  return go;
}

Result<std::vector<TidyEntry>> entries_of(const fs::path& folder) {
  std::vector<TidyEntry> entries;
  std::set<std::string> in_use;
  std::error_code failed;
  fs::directory_iterator entry(folder, failed);
  if (failed) {
    return Error(failed == std::errc::no_such_file_or_directory ? ErrorCode::kNotFound : ErrorCode::kSystem,
                 fmt::format("reading the folder '{}': {}", folder.string(), failed.message()));
  }
  for (const fs::directory_iterator end; !failed && entry != end; entry.increment(failed)) {
    if (entry->is_symlink(failed)) {
      in_use.insert(entry_of_link(entry->path(), folder));
      continue;
    }
    TidyEntry one;
    one.name = entry->path().filename().string();
    measure(entry->path(), &one);
    entries.push_back(std::move(one));
  }
  for (fs::directory_iterator beside(folder.lexically_normal().parent_path(), failed), end; !failed && beside != end;
       beside.increment(failed)) {
    if (beside->is_symlink(failed)) in_use.insert(entry_of_link(beside->path(), folder));
  }
  for (TidyEntry& one : entries) one.is_in_use = in_use.contains(one.name);
  return entries;
}

Result<std::vector<TidyEntry>> tidy(const fs::path& folder, const TidyLimits& limits, bool only_look) {
  TRY_ASSIGN(std::vector<TidyEntry> entries, entries_of(folder));
  struct statvfs disk {};
  if (::statvfs(folder.c_str(), &disk) != 0) return Error::from_errno(fmt::format("looking at '{}'", folder.string()));
  std::vector<TidyEntry> go =
      too_much(std::move(entries), limits, std::uint64_t{disk.f_bavail} * std::uint64_t{disk.f_frsize});
  if (only_look) return go;
  std::erase_if(go, [&](const TidyEntry& entry) {
    std::error_code failed;
    fs::remove_all(folder / entry.name, failed);
    return static_cast<bool>(failed);
  });
  return go;
}

}  // namespace cyclorama
