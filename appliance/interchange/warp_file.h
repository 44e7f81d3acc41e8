// SPDX-License-Identifier: Apache-2.0
/// Any warp file, told by the ending of its name, as a WarpSet; and back.
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

/// What some formats do not say.
struct WarpFileOptions {
  int width_px = 1920;  ///< The projector's, for meshes: they are drawn into a map of that size. Also gives the aspect.
  int height_px = 1080;
  int columns = 65;  ///< Of a grid that is written.
  int rows = 37;
  WarpProfile profile = WarpProfile::k2d;     ///< Of a PFM.
  std::optional<std::filesystem::path> mask;  ///< Beside a PFM.
  MpcdiVersion version = MpcdiVersion::k2_0;  ///< Of an MPCDI file that is written.
};

struct WarpFile {
  WarpSet set;
  std::vector<std::string> ignored;  ///< As MpcdiFile::ignored.
};

/// kInvalidArgument  no format has such an ending.     Else the errors of the format's reader.
Result<WarpFile> read_warp_file(const std::filesystem::path& path, const WarpFileOptions& options);

/// The region of that id; of no id, the only one there is. It lives as long as the set.
/// kInvalidArgument  there is none, or which one is not said: names those that there are.
Result<const WarpRegion*> chosen_region(const WarpSet& set, const std::string& id);

/// One region goes into all formats but MPCDI: `region` names it, or is empty where there is only one. Meshes lose the
/// beta map and what lies in space. A mesh is written from the even grid of net_from(); an OBJ and a PFM write the
/// alpha beside them, as PNG (options.mask, or the same name with .png).
/// kInvalidArgument  no format has such an ending, no such region, or a map in space for a flat format.
Status write_warp_file(const std::filesystem::path& path, const WarpSet& set, const std::string& region,
                       const WarpFileOptions& options);

}  // namespace cyclorama::interchange
