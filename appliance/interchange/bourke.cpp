// SPDX-License-Identifier: Apache-2.0
#include "appliance/interchange/mesh_files.h"
#include "appliance/interchange/text_lines.h"

namespace cyclorama::interchange {
namespace {

constexpr int kPolar = 1;
constexpr int kRectangular = 2;
constexpr std::size_t kFields = 5;

Status check_aspect(double aspect) {
  if (aspect >= 0.05 && aspect <= 20.0) return Done{};
  return Error(ErrorCode::kInvalidArgument, fmt::format("an aspect ratio of {}; give 0.05 to 20", aspect));
}

Result<long long> count_in(std::string_view field, const std::string& location) {
  const auto value = parse_integer(field);
  if (!value || *value < 1 || *value > static_cast<long long>(kMaxWarpNodes)) {
    return fault(location, fmt::format("'{}' is no count", printable(field)), "export the mesh again");
  }
  return *value;
}

}  // namespace

Result<WarpNet> parse_bourke(std::string_view text, double aspect) {
  TRY(check_aspect(aspect));
  TextLines lines(text);
  const auto type_line = lines.next();
  const auto type = type_line ? parse_integer(*type_line) : std::nullopt;
  if (!type || (*type != kPolar && *type != kRectangular)) {
    return fault("line 1", "no mesh type of 1 (polar) or 2 (rectangular)", "give a Bourke mesh in its text form");
  }
  const auto size_line = lines.next();
  const auto sizes = size_line ? fields_of(*size_line) : std::vector<std::string_view>();
  if (sizes.size() != 2) return fault(lines.location(), "no columns and rows", "export the mesh again");
  TRY_ASSIGN(const long long columns, count_in(sizes[0], lines.location()));
  TRY_ASSIGN(const long long rows, count_in(sizes[1], lines.location()));
  if (columns < 2 || rows < 2 || columns > static_cast<long long>(kMaxWarpNodes) / rows) {
    return fault(lines.location(), fmt::format("a mesh of {}x{} nodes", columns, rows),
                 fmt::format("export at least 2x2 and at most {} nodes", kMaxWarpNodes));
  }
  WarpNet net;
  net.columns = static_cast<int>(columns);
  net.rows = static_cast<int>(rows);
  net.closed = *type == kPolar;
  const auto count = static_cast<std::size_t>(columns * rows);
  while (const auto line = lines.next()) {
    if (net.nodes.size() == count) {
      return fault(lines.location(), fmt::format("more than {}x{} nodes", columns, rows), "correct the second line");
    }
    const auto fields = fields_of(*line);
    if (fields.size() != kFields) {
      return fault(lines.location(), fmt::format("{} numbers, and a node has {}", fields.size(), kFields),
                   "give x, y, u, v and intensity");
    }
    std::array<double, kFields> values{};
    for (std::size_t i = 0; i < kFields; ++i) {
      TRY_ASSIGN(values[i], number_of(fields[i], lines.location()));
    }
    net.nodes.push_back({0.5 * (values[0] / aspect + 1.0), 0.5 * (values[1] + 1.0), values[2], values[3], values[4]});
  }
  if (net.nodes.size() != count) {
    return fault(fmt::format("after {}", lines.location()),
                 fmt::format("{} nodes, and {}x{} are announced", net.nodes.size(), columns, rows),
                 "copy or export the mesh again");
  }
  TRY(check(net));
  return net;
}

Result<std::string> print_bourke(const WarpNet& net, double aspect) {
  TRY(check_aspect(aspect));
  TRY(check(net));
  if (net.columns == 0) {
    return Error(ErrorCode::kInvalidArgument, "a Bourke mesh is a grid, and this is none; write it as OBJ");
  }
  std::string text = fmt::format("{}\n{} {}\n", net.closed ? kPolar : kRectangular, net.columns, net.rows);
  for (const WarpNode& node : net.nodes) {
    text += fmt::format("{} {} {} {} {}\n", decimals((2.0 * node.x - 1.0) * aspect), decimals(2.0 * node.y - 1.0),
                        decimals(node.u), decimals(node.v), decimals(node.light));
  }
  return text;
}

}  // namespace cyclorama::interchange
