// SPDX-License-Identifier: Apache-2.0
/// Warps as meshes in the text formats of other programs. Errors of the readers: kBadData with the line and the remedy;
/// functions with a path also name the file. Reentrant.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "appliance/interchange/warp_net.h"

namespace cyclorama::interchange {

/// Parses Paul Bourke's ".data": type (1 polar, 2 rectangular), columns and rows, and "x y u v intensity" per node,
/// where y is -1 to 1 from the bottom and x is -aspect to aspect. `aspect` (width over height of the projector) is not
/// in the file. Source: Bourke, "Mesh format for image warping", paulbourke.net/dataformats/meshwarp, 2006; the text
/// form.
Result<WarpNet> parse_bourke(std::string_view text, double aspect);
/// Prints a net for parse_bourke(), with seven decimals. Errors: kInvalidArgument if the net is not a grid; those of
/// check().
Result<std::string> print_bourke(const WarpNet& net, double aspect);

/// Parses a flat Wavefront OBJ: "v x y 0" with x and y from -1 to 1 over the projector's picture, "vt u v", and faces
/// with indices of both; for faces without texture indices, the vertex indices are used. Normals, groups and materials
/// are skipped. SGCT reads this form.
Result<WarpNet> parse_warp_obj(std::string_view text);
/// Prints a net for parse_warp_obj(), with seven decimals. The light of nodes is lost, except that areas that are not
/// drawn have no face. Errors: those of check().
Result<std::string> print_warp_obj(const WarpNet& net);

/// Parses domeprojection.com's CSV: "x;y;u;v;column;row" per node, all counted from the UPPER left corner; a first line
/// of names is skipped. Each node of the grid occurs once, in any order.
Result<WarpNet> parse_domeprojection(std::string_view text);

/// Parses SimCAD (XML of Barco projectors): <GeometryFile><GeometryDefinition> with <X-FlatParameters range="1"> and
/// <Y-FlatParameters range="1">. These contain the shifts of the nodes of a square grid to the right and down, as
/// shares of the picture, row by row from the top.
Result<WarpNet> parse_simcad(std::string_view text);

Result<WarpNet> read_bourke(const std::filesystem::path& path, double aspect);
Result<WarpNet> read_warp_obj(const std::filesystem::path& path);
Result<WarpNet> read_domeprojection(const std::filesystem::path& path);
Result<WarpNet> read_simcad(const std::filesystem::path& path);
Status write_bourke(const std::filesystem::path& path, const WarpNet& net, double aspect);
Status write_warp_obj(const std::filesystem::path& path, const WarpNet& net);

}  // namespace cyclorama::interchange
