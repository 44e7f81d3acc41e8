// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <functional>
#include <vector>

#include "common/base/result.h"
#include "renderfarm/scene_distribution/digest_memory.h"
#include "renderfarm/scene_distribution/scene_files.h"

namespace cyclorama {

/// A scene on this machine's disk, by its files' digests.
struct SceneListing {
  struct Place {
    std::filesystem::path path;
    FileStamp stamp;
  };
  SceneFiles files;
  std::vector<Place> places;  ///< Of each of the files.
};

/// Reads the files of a scene package's folder, all of them and those of its folders, but hidden ones; or of one .ply
/// or .glb file. What `memory` knows is not read again, what is read it learns. `go_on` is told the fraction that is
/// done, and gives up by false. Blocks for as long as the disk takes.
///
/// kNotFound     no such folder, or it has no scene.toml.
/// kBadData      a link, a device, a name that check_scene_path() refuses, a single file that refers to others.
/// kBusy         a file was changed meanwhile: try again.      kUnavailable  given up.
Result<SceneListing> list_scene(const std::filesystem::path& path, DigestMemory& memory,
                                const std::function<bool(double)>& go_on);

}  // namespace cyclorama
