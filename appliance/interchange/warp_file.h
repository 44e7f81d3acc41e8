// SPDX-License-Identifier: Apache-2.0
/// Reads and writes warp files of any format, which the file name extension determines.
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

/// Parameters that are missing in some formats.
struct WarpFileOptions {
  /// Size of the projector's picture: meshes are drawn into a map of this size. It also gives the aspect ratio.
  int width_px = 1920;
  int height_px = 1080;
  /// Size of the grid to write. If absent, a mesh is written as it was read, and other maps as kDefaultGrid.
  std::optional<WarpGridSize> grid;
  WarpProfile profile = WarpProfile::k2d;     ///< For reading a PFM.
  std::optional<std::filesystem::path> mask;  ///< PNG that accompanies a PFM.
  MpcdiVersion version = MpcdiVersion::k2_0;  ///< For writing an MPCDI file.
};

struct WarpFile {
  WarpSet set;
  std::vector<std::string> ignored;  ///< See MpcdiFile::ignored.
  std::optional<WarpNet> mesh;       ///< Mesh from which the only region of `set` was drawn, if the file has one.
};

/// Reads a file. Errors: kInvalidArgument if no format has this file name extension; else those of the format's reader.
Result<WarpFile> read_warp_file(const std::filesystem::path& path, const WarpFileOptions& options);

/// Returns the region `id`, or the only region if `id` is empty; the pointer is valid as long as the set. Errors:
/// kInvalidArgument, with the ids of the set, if there is no such region, or `id` is empty and there are several.
Result<const WarpRegion*> chosen_region(const WarpSet& set, const std::string& id);

/// Writes the region `region`, or the only region if `region` is empty; MPCDI files get the whole set. Meshes have no
/// beta map and no points in space. A mesh that was read keeps its nodes unless options.grid is given, so that a
/// conversion to the same format changes nothing; otherwise the mesh is the regular grid of net_from(). A .data file
/// needs a grid, so a mesh of triangles is converted to one. With an OBJ or a PFM, the alpha is written as a PNG
/// (options.mask, or the same name with .png). Errors: kInvalidArgument if no format has this file name extension,
/// there is no such region, or a map in space is written to a flat format.
Status write_warp_file(const std::filesystem::path& path, const WarpFile& file, const std::string& region,
                       const WarpFileOptions& options);

}  // namespace cyclorama::interchange
