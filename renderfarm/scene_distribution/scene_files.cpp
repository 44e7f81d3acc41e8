// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/scene_distribution/scene_files.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <set>

#include "common/base/text.h"
#include "renderfarm/scene_distribution/sha256.h"

namespace cyclorama::scene_distribution {
namespace {

constexpr std::size_t kMaxPathBytes = 1024;
constexpr std::size_t kMaxPathPartBytes = 255;  // Limit of Linux' file systems.
constexpr std::ptrdiff_t kMaxPathParts = 16;

Error bad(const std::string& what) { return Error(ErrorCode::kBadData, what); }

std::string lower_case(std::string text) {
  for (char& c : text) {
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
  }
  return text;
}

Status check_parts(std::string_view path) {
  for (std::size_t begin = 0; begin <= path.size();) {
    const std::size_t end = std::min(path.find('/', begin), path.size());
    const std::string_view part = path.substr(begin, end - begin);
    if (part.empty() || part.size() > kMaxPathPartBytes || part.front() == '.') {
      return bad(fmt::format("'{}' has a part that is empty, begins with a dot or is longer than {} bytes; rename it",
                             printable(path, 200), kMaxPathPartBytes));
    }
    begin = end + 1;
  }
  return Done{};
}

}  // namespace

Status check_scene_path(std::string_view path) {
  if (path.empty() || path.size() > kMaxPathBytes || std::ranges::count(path, '/') >= kMaxPathParts) {
    return bad(fmt::format("'{}': a path has 1 to {} bytes and at most {} folders; rename it", printable(path, 200),
                           kMaxPathBytes, kMaxPathParts - 1));
  }
  if (printable(path, path.size()) != path) {
    return bad(fmt::format("'{}' is not UTF-8, or has control characters; rename it", printable(path, 200)));
  }
  return check_parts(path);
}

Status validate(const SceneFiles& files) {
  if (files.empty()) return bad("a scene has no files");
  if (files.size() > kMaxSceneFiles) {
    return bad(fmt::format("a scene has {} files; at most {} are taken", files.size(), kMaxSceneFiles));
  }
  std::uint64_t left = kMaxSceneBytes;
  std::map<std::string, std::uint64_t> sizes;
  std::set<std::string> names;    // In lower case.
  std::set<std::string> folders;  // In lower case.
  const SceneFile* last = nullptr;
  for (const SceneFile& file : files) {
    TRY(check_scene_path(file.path));
    if (!is_sha256(file.sha256)) return bad(fmt::format("'{}' has no SHA-256", file.path));
    if (file.bytes > left) return bad(fmt::format("a scene has more than {} GiB", kMaxSceneBytes >> 30));
    left -= file.bytes;
    if (sizes.emplace(file.sha256, file.bytes).first->second != file.bytes) {
      return bad(fmt::format("'{}' has the SHA-256 of a file of another size", file.path));
    }
    if (last != nullptr && !(last->path < file.path)) return bad("a scene's files are not in order, or come twice");
    const std::string name = lower_case(file.path);
    if (!names.insert(name).second) {
      return bad(fmt::format("'{}' differs from another file only in the case of its letters; rename it", file.path));
    }
    for (std::size_t at = name.find('/'); at != std::string::npos; at = name.find('/', at + 1)) {
      folders.insert(name.substr(0, at));
    }
    last = &file;
  }
  for (const std::string& folder : folders) {
    if (names.contains(folder)) return bad(fmt::format("'{}' is both a file and a folder; rename one", folder));
  }
  return Done{};
}

std::string text_of(const SceneFiles& files) {
  std::string text = "cyclorama scene files 1\n";
  for (const SceneFile& file : files) text += fmt::format("{} {} {}\n", file.sha256, file.bytes, file.path);
  return text;
}

std::string digest_of(const SceneFiles& files) { return sha256_of(text_of(files)); }

std::uint64_t bytes_of(const SceneFiles& files) {
  std::uint64_t sum = 0;
  for (const SceneFile& file : files) sum += file.bytes;
  return sum;
}

wire::SceneFiles to_wire(const SceneFiles& files) {
  wire::SceneFiles message;
  for (const SceneFile& file : files) {
    wire::SceneFile* const out = message.add_files();
    out->set_path(file.path);
    out->set_bytes(file.bytes);
    out->set_sha256(file.sha256);
  }
  return message;
}

Result<SceneFiles> from_wire(const wire::SceneFiles& message, std::string_view digest) {
  SceneFiles files;
  for (const wire::SceneFile& file : message.files()) files.push_back({file.path(), file.bytes(), file.sha256()});
  std::ranges::sort(files, {}, &SceneFile::path);
  TRY(validate(files));
  if (digest_of(files) != digest) return bad("the list of files is not the requested one");
  return files;
}

}  // namespace cyclorama::scene_distribution
