// SPDX-License-Identifier: Apache-2.0
/// Which files make a scene, and the one digest that names them all.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "common/base/result.h"
#include "common/wire/nodes.pb.h"

namespace cyclorama {

struct SceneFile {
  std::string path;  ///< Inside the scene, as check_scene_path() wants it.
  std::uint64_t bytes = 0;
  std::string sha256;  ///< Of its bytes, as is_sha256() wants it.
  bool operator==(const SceneFile&) const = default;
};

/// In the order of their paths' bytes. One file that is not scene.toml is a scene by itself; else it is a folder.
using SceneFiles = std::vector<SceneFile>;

/// A list of so many of the longest paths still is one gRPC message.
inline constexpr std::size_t kMostSceneFiles = 10'000;
inline constexpr std::uint64_t kMostSceneBytes = std::uint64_t{1} << 40;

/// Relative, in UTF-8, up to 1024 bytes with '/' between its parts, of which there are at most 16, each of 1 to 255
/// bytes; no control characters, and no part begins with a dot: so neither '.' nor '..' nor a hidden file.
/// kBadData, with a remedy for who made the folder.
Status check_scene_path(std::string_view path);

/// What a list must be to be made into files: paths as above, in order, unlike each other in more than the case of
/// letters, none inside of another that is a file; digests; the same bytes for the same digest; the limits above.
/// kBadData.
Status validate(const SceneFiles& files);

/// What the digest is of. Precondition: validate().
[[nodiscard]] std::string text_of(const SceneFiles& files);
[[nodiscard]] std::string digest_of(const SceneFiles& files);
[[nodiscard]] std::uint64_t bytes_of(const SceneFiles& files);

[[nodiscard]] wire::SceneFiles to_wire(const SceneFiles& files);
/// Sorted and validated. kBadData  it is no such list, or `digest` is not its digest.
Result<SceneFiles> from_wire(const wire::SceneFiles& message, std::string_view digest);

}  // namespace cyclorama
