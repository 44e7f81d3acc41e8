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

/// Parameters that some formats lack.
struct WarpFileOptions {
  /// Size of the projector's picture, for meshes: they are drawn into a map of that size. Also gives the aspect.
  int width_px = 1920;
  int height_px = 1080;
  int columns = 65;  ///< Size of a grid that is written.
  int rows = 37;
  WarpProfile profile = WarpProfile::k2d;     ///< For a PFM.
  std::optional<std::filesystem::path> mask;  ///< PNG that accompanies a PFM.
  MpcdiVersion version = MpcdiVersion::k2_0;  ///< For writing an MPCDI file.
};

struct WarpFile {
  WarpSet set;
  std::vector<std::string> ignored;  ///< Same as MpcdiFile::ignored.
};

/// Errors: kInvalidArgument if no format has this file name extension; else those of the format's reader.
Result<WarpFile> read_warp_file(const std::filesystem::path& path, const WarpFileOptions& options);

/// Returns the region `id`; if `id` is empty, the only one. It lives as long as the set. Errors: kInvalidArgument if
/// there is none, or `id` is empty and there are several; names the existing ones.
Result<const WarpRegion*> chosen_region(const WarpSet& set, const std::string& id);

/// Writes one region, or for MPCDI the whole set: `region` names it, or is empty if there is only one. Meshes lose the
/// beta map and three-dimensional points. A mesh is written from the even grid of net_from(); an OBJ and a PFM write
/// the alpha beside them, as PNG (options.mask, or the same name with .png). Errors: kInvalidArgument if no format has
/// this file name extension, there is no such region, or a map in space is written to a flat format.
Status write_warp_file(const std::filesystem::path& path, const WarpSet& set, const std::string& region,
                       const WarpFileOptions& options);

}  // namespace cyclorama::interchange
