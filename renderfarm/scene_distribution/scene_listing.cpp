// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/scene_distribution/scene_listing.h"

#include <fmt/format.h>

#include <algorithm>
#include <system_error>

namespace cyclorama::scene_distribution {
namespace {

namespace fs = std::filesystem;

Error bad(const std::string& what) { return Error(ErrorCode::kBadData, what); }

Error system_error(const fs::path& path, const std::error_code& code) {
  return Error(code == std::errc::no_such_file_or_directory ? ErrorCode::kNotFound : ErrorCode::kSystem,
               fmt::format("reading '{}': {}", path.string(), code.message()));
}

Result<std::vector<std::string>> names_in(const fs::path& folder) {
  std::vector<std::string> names;
  std::error_code error;
  for (fs::recursive_directory_iterator at(folder, error), end; !error && at != end; at.increment(error)) {
    const fs::file_status status = at->symlink_status(error);
    if (error) break;
    if (at->path().filename().string().starts_with('.')) {
      if (fs::is_directory(status)) at.disable_recursion_pending();
      continue;
    }
    const std::string name = at->path().lexically_relative(folder).generic_string();
    if (fs::is_directory(status)) {
      TRY(check_scene_path(name));  // Checked here, too, so that the search is not deeper than a list may be.
      continue;
    }
    if (!fs::is_regular_file(status)) {
      return bad(fmt::format("'{}' is a link or no regular file; put the file itself there", at->path().string()));
    }
    names.push_back(name);
    if (names.size() > kMaxSceneFiles) {
      return bad(
          fmt::format("'{}' has more than {} files; keep only the scene's there", folder.string(), kMaxSceneFiles));
    }
  }
  if (error) return system_error(folder, error);
  if (std::ranges::find(names, "scene.toml") == names.end()) {
    return Error(ErrorCode::kNotFound, fmt::format("'{}' is no scene package: it has no scene.toml", folder.string()));
  }
  std::ranges::sort(names);
  return names;
}

struct Found {
  fs::path folder;
  std::vector<std::string> names;
};

Result<Found> find_files(const fs::path& path) {
  std::error_code error;
  const fs::file_status status = fs::status(path, error);
  if (!fs::exists(status)) return system_error(path, error);
  if (fs::is_directory(status)) {
    TRY_ASSIGN(auto names, names_in(path));
    return Found{path, std::move(names)};
  }
  const std::string extension = path.extension().string();
  if (extension != ".ply" && extension != ".glb") {
    return bad(
        fmt::format("'{}' may refer to other files; put it in a folder with them and a scene.toml that names "
                    "it, and give the folder",
                    path.string()));
  }
  return Found{path.parent_path(), {path.filename().string()}};
}

}  // namespace

Result<SceneListing> list_scene(const fs::path& path, DigestMemory& memory,
                                const std::function<bool(double)>& should_continue) {
  TRY_ASSIGN(const Found found, find_files(path));
  SceneListing listing;
  std::uint64_t all = 0;
  for (const std::string& name : found.names) {
    TRY_ASSIGN(const StampedFile file, open_stamped(found.folder / name));
    TRY(check_scene_path(name));
    listing.places.push_back({found.folder / name, file.stamp});
    all += file.stamp.bytes;
  }
  std::uint64_t done = 0;
  const auto count = [&](std::uint64_t bytes) {
    done += bytes;
    return should_continue(
        std::min(1.0, static_cast<double>(done) / static_cast<double>(std::max<std::uint64_t>(all, 1))));
  };
  for (std::size_t i = 0; i < found.names.size(); ++i) {
    SceneListing::Place& place = listing.places[i];
    std::optional<std::string> sha256 = memory.find(place.path, place.stamp);
    if (sha256) {
      if (!count(place.stamp.bytes)) return Error(ErrorCode::kUnavailable, "given up");
    } else {
      TRY_ASSIGN(HashedFile hashed, hash_file(place.path, count));
      memory.keep(place.path, hashed);
      place.stamp = hashed.stamp;
      sha256 = std::move(hashed.sha256);
    }
    listing.files.push_back({found.names[i], place.stamp.bytes, *std::move(sha256)});
  }
  TRY(validate(listing.files));
  return listing;
}

}  // namespace cyclorama::scene_distribution
