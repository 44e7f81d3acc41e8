// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <functional>
#include <vector>

#include "common/base/result.h"
#include "renderfarm/scene_distribution/digest_memory.h"
#include "renderfarm/scene_distribution/scene_files.h"

namespace cyclorama::scene_distribution {

/// A scene on this machine's disk, with the digests of its files.
struct SceneListing {
  struct Place {
    std::filesystem::path path;
    FileStamp stamp;
  };
  SceneFiles files;
  std::vector<Place> places;  ///< Location of each file.
};

/// Lists a scene: all files of a scene package's folder and its subfolders except hidden ones, or one .ply or .glb
/// file. Files known to `memory` are not read again; new digests are added to it. `should_continue` receives the
/// completed fraction and returns false to give up. Blocks while the disk is read.
///
/// Errors:
/// kNotFound     there is no such folder, or it has no scene.toml.
/// kBadData      there is a link, a device, a name that check_scene_path() refuses, or one file that refers to others.
/// kBusy         a file was changed meanwhile: try again.
/// kUnavailable  `should_continue` returned false.
Result<SceneListing> list_scene(const std::filesystem::path& path, DigestMemory& memory,
                                const std::function<bool(double)>& should_continue);

}  // namespace cyclorama::scene_distribution
