// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/scene_distribution/digest_memory.h"

#include <fmt/format.h>

#include <chrono>
#include <sstream>

#include "common/base/file.h"
#include "renderfarm/scene_distribution/sha256.h"

namespace cyclorama::scene_distribution {
namespace {

constexpr std::size_t kMaxBytes = std::size_t{64} << 20;
/// Upper bound for the resolution of file systems' clocks; FAT's is two seconds.
constexpr std::int64_t kTick_ns = 2'000'000'000;

std::int64_t wall_clock_ns() {
  return std::chrono::duration_cast<std::chrono::nanoseconds>(std::chrono::system_clock::now().time_since_epoch())
      .count();
}

}  // namespace

DigestMemory::DigestMemory(std::filesystem::path file) : file_(std::move(file)) {
  if (file_.empty()) return;
  const auto text = read_text_file(file_, kMaxBytes);
  if (!text) return;
  std::istringstream lines(*text);
  for (std::string line; std::getline(lines, line);) {
    std::istringstream words(line);
    HashedFile hashed;
    std::string path;
    FileStamp& stamp = hashed.stamp;
    if (!(words >> hashed.sha256 >> stamp.inode >> stamp.bytes >> stamp.modified_ns >> stamp.changed_ns)) continue;
    if (words.get() != ' ' || !std::getline(words, path) || !is_sha256(hashed.sha256)) continue;
    known_[path] = std::move(hashed);
  }
}

std::optional<std::string> DigestMemory::find(const std::filesystem::path& path, const FileStamp& stamp) const {
  const auto known = known_.find(path.string());
  if (known == known_.end() || known->second.stamp != stamp) return std::nullopt;
  return known->second.sha256;
}

void DigestMemory::keep(const std::filesystem::path& path, const HashedFile& hashed) {
  if (hashed.stamp.changed_ns > wall_clock_ns() - kTick_ns || path.string().find('\n') != std::string::npos) return;
  known_[path.string()] = hashed;
  changed_ = true;
}

Status DigestMemory::save() {
  if (file_.empty() || !changed_) return Done{};
  std::string text;
  for (const auto& [path, hashed] : known_) {
    const FileStamp& stamp = hashed.stamp;
    text += fmt::format("{} {} {} {} {} {}\n", hashed.sha256, stamp.inode, stamp.bytes, stamp.modified_ns,
                        stamp.changed_ns, path);
  }
  TRY(write_file_atomically(file_, text));
  changed_ = false;
  return Done{};
}

}  // namespace cyclorama::scene_distribution
