// SPDX-License-Identifier: Apache-2.0
/// Warps as meshes, in the text formats of other programs. Every reader's errors are kBadData with the line and the
/// remedy; the functions that take a path name the file too. Reentrant.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "appliance/interchange/warp_net.h"

namespace cyclorama::interchange {

/// Paul Bourke's ".data": type (1 polar, 2 rectangular), columns and rows, and "x y u v intensity" per node, where y is
/// -1 to 1 from the bottom and x is -aspect to aspect. `aspect` (width over height of the projector) is not in the
/// file. Source: Bourke, "Mesh format for image warping", paulbourke.net/dataformats/meshwarp, 2006; its text form.
Result<WarpNet> parse_bourke(std::string_view text, double aspect);
/// Prints seven decimals. Errors: kInvalidArgument if the net is no grid; those of check().
Result<std::string> print_bourke(const WarpNet& net, double aspect);

/// Wavefront OBJ, flat: "v x y 0" with x and y -1 to 1 over the projector's picture, "vt u v", and faces of both; faces
/// without texture indices use those of the vertices. Normals, groups and materials are skipped. SGCT reads this form.
Result<WarpNet> parse_warp_obj(std::string_view text);
/// Prints seven decimals. The light of nodes is lost, except that areas that are not drawn have no face. Errors:
/// kBadData as check().
Result<std::string> print_warp_obj(const WarpNet& net);

/// domeprojection.com's CSV: "x;y;u;v;column;row" per node, all of them from the UPPER left corner; a first line of
/// names is skipped. Each node of the grid occurs once, in any order.
Result<WarpNet> parse_domeprojection(std::string_view text);

/// SimCAD (Barco projectors' XML): <GeometryFile><GeometryDefinition> with <X-FlatParameters range="1"> and
/// <Y-FlatParameters range="1">: shifts of the nodes of a square grid to the right and down, as a share of the picture,
/// row by row from the top.
Result<WarpNet> parse_simcad(std::string_view text);

Result<WarpNet> read_bourke(const std::filesystem::path& path, double aspect);
Result<WarpNet> read_warp_obj(const std::filesystem::path& path);
Result<WarpNet> read_domeprojection(const std::filesystem::path& path);
Result<WarpNet> read_simcad(const std::filesystem::path& path);
Status write_bourke(const std::filesystem::path& path, const WarpNet& net, double aspect);
Status write_warp_obj(const std::filesystem::path& path, const WarpNet& net);

}  // namespace cyclorama::interchange
