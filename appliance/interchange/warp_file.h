// SPDX-License-Identifier: Apache-2.0
/// Reads any warp file into a WarpSet and writes one, by its file name extension.
///
///   .mpcdi .xml   MPCDI            read, written (.mpcdi)
///   .pfm          map, and .png    read, written
///   .data         Bourke           read, written
///   .obj          OBJ              read, written
///   .csv          domeprojection   read
///   .simcad       SimCAD           read
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "appliance/interchange/warp_net.h"
#include "appliance/interchange/warp_set.h"

namespace cyclorama::interchange {

struct WarpGridSize {
  int columns = 0;
  int rows = 0;
};
inline constexpr WarpGridSize kDefaultGrid{65, 37};

/// Parameters that some formats lack.
struct WarpFileOptions {
  /// Size of the projector's picture, for meshes: they are drawn into a map of that size. Also gives the aspect.
  int width_px = 1920;
  int height_px = 1080;
  /// Size of a grid that is written. Without it, a mesh is written as it was read, and other maps as kDefaultGrid.
  std::optional<WarpGridSize> grid;
  WarpProfile profile = WarpProfile::k2d;     ///< For a PFM.
  std::optional<std::filesystem::path> mask;  ///< PNG that accompanies a PFM.
  MpcdiVersion version = MpcdiVersion::k2_0;  ///< For writing an MPCDI file.
};

struct WarpFile {
  WarpSet set;
  std::vector<std::string> ignored;  ///< Same as MpcdiFile::ignored.
  std::optional<WarpNet> mesh;       ///< Present if the file holds a mesh: the only region of `set` was drawn from it.
};

/// Errors: kInvalidArgument if no format has this file name extension; else those of the format's reader.
Result<WarpFile> read_warp_file(const std::filesystem::path& path, const WarpFileOptions& options);

/// Returns the region `id`; if `id` is empty, the only one. It lives as long as the set. Errors: kInvalidArgument if
/// there is none, or `id` is empty and there are several; names the existing ones.
Result<const WarpRegion*> chosen_region(const WarpSet& set, const std::string& id);

/// Writes one region, or for MPCDI the whole set: `region` names it, or is empty if there is only one. Meshes lose the
/// beta map and three-dimensional points. A mesh that was read as one keeps its nodes unless options.grid is given, so
/// converting a file to its own format changes nothing; otherwise it is the even grid of net_from(). A .data file needs
/// a grid: a mesh of triangles becomes one. An OBJ and a PFM write the alpha beside them, as PNG (options.mask, or the same name with .png). Errors: kInvalidArgument if no format has
/// this file name extension, there is no such region, or a map in space is written to a flat format.
Status write_warp_file(const std::filesystem::path& path, const WarpFile& file, const std::string& region,
                       const WarpFileOptions& options);

}  // namespace cyclorama::interchange
