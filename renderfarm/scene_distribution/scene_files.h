// SPDX-License-Identifier: Apache-2.0
/// The list of files that make up a scene, and its digest.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "common/base/result.h"
#include "common/wire/nodes.pb.h"

namespace cyclorama::scene_distribution {

struct SceneFile {
  std::string path;  ///< Path inside the scene; see check_scene_path().
  std::uint64_t bytes = 0;
  std::string sha256;  ///< Digest of the bytes; see is_sha256().
  bool operator==(const SceneFile&) const = default;
};

/// The files of a scene, ordered by the bytes of their paths. A single file other than scene.toml is a scene by itself;
/// otherwise the scene is a folder.
using SceneFiles = std::vector<SceneFile>;

/// Maximum number of files. A list of this many paths of maximum length fits into one gRPC message.
inline constexpr std::size_t kMaxSceneFiles = 10'000;
inline constexpr std::uint64_t kMaxSceneBytes = std::uint64_t{1} << 40;

/// Checks that a path is relative UTF-8 of at most 1024 bytes without control characters, with at most 16 parts of 1 to
/// 255 bytes separated by '/'. No part may begin with a dot, which excludes '.', '..' and hidden files. Errors:
/// kBadData, with a remedy for the folder's author.
Status check_scene_path(std::string_view path);

/// Checks a list before files are made from it: paths must be valid and ordered, differ in more than the case of
/// letters, and not be inside another path that is a file; digests must be valid, and equal digests must have equal
/// sizes; the limits above apply. Errors: kBadData.
Status validate(const SceneFiles& files);

/// Returns the text that digest_of() hashes. Precondition: validate(files) succeeds.
[[nodiscard]] std::string text_of(const SceneFiles& files);
[[nodiscard]] std::string digest_of(const SceneFiles& files);
[[nodiscard]] std::uint64_t bytes_of(const SceneFiles& files);

[[nodiscard]] wire::SceneFiles to_wire(const SceneFiles& files);
/// Returns a sorted and validated list. Errors: kBadData if the list is invalid or `digest` is not its digest.
Result<SceneFiles> from_wire(const wire::SceneFiles& message, std::string_view digest);

}  // namespace cyclorama::scene_distribution
