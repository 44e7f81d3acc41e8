// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/node/light_files.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cstdint>
#include <utility>
#include <vector>

namespace cyclorama::node {
namespace {

namespace fs = std::filesystem;

constexpr const char* kInScene = "light.store";  ///< Equals light::kLightFileName.
constexpr std::size_t kMaxFiles = 64;

/// Returns a file name for a path. Two paths with the same name replace each other's light, which is harmless: a scene
/// rejects light that is not its own. Source: FNV-1a, http://www.isthe.com/chongo/tech/comp/fnv.
std::string name_of(const std::string& path) {
  std::uint64_t hash = 0xcbf29ce484222325u;
  for (const char byte : path) hash = (hash ^ static_cast<unsigned char>(byte)) * 0x100000001b3u;
  return fmt::format("{:016x}.store", hash);
}

void remove_oldest(const fs::path& folder) {
  std::vector<std::pair<fs::file_time_type, fs::path>> files;
  std::error_code error;
  for (fs::directory_iterator at(folder, error), end; !error && at != end; at.increment(error)) {
    std::error_code unknown;
    files.emplace_back(at->last_write_time(unknown), at->path());
  }
  std::ranges::sort(files);
  for (std::size_t i = 0; i + kMaxFiles <= files.size(); ++i) fs::remove_all(files[i].second, error);
}

}  // namespace

fs::path LightFiles::file_of(const std::string& path) const {
  if (!cache_.empty()) return cache_ / "light" / name_of(path);
  std::error_code none;
  return fs::is_directory(path, none) ? fs::path(path) / kInScene : fs::path();
}

Result<fs::path> LightFiles::prepare(const std::string& path) const {
  const fs::path file = file_of(path);
  if (file.empty()) {
    return Error(ErrorCode::kInvalidArgument,
                 fmt::format("there is no folder for the light of '{}'; give the node a cache", path));
  }
  std::error_code error;
  if (!cache_.empty()) fs::create_directories(file.parent_path(), error);
  if (::access(file.parent_path().c_str(), W_OK) != 0) {
    return Error::from_errno(fmt::format("writing to '{}'", file.parent_path().string()))
        .while_doing("give the node a cache for computed light");
  }
  if (!cache_.empty()) remove_oldest(file.parent_path());
  return file;
}

void LightFiles::remove_left_over(const fs::path& file) {
  // An incomplete file has the name of `file`, a dot, and six more characters.
  const std::string begin = file.filename().string() + ".";
  std::error_code error;
  std::vector<fs::path> left_over;
  for (fs::directory_iterator at(file.parent_path(), error), end; !error && at != end; at.increment(error)) {
    const std::string name = at->path().filename().string();
    if (name.starts_with(begin) && name.size() == begin.size() + 6) left_over.push_back(at->path());
  }
  for (const fs::path& path : left_over) fs::remove(path, error);
}

}  // namespace cyclorama::node
