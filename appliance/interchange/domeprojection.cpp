// SPDX-License-Identifier: Apache-2.0
#include <array>

#include "appliance/interchange/mesh_files.h"
#include "appliance/interchange/text_lines.h"

namespace cyclorama::interchange {
namespace {

constexpr std::size_t kFields = 6;
constexpr long long kMaxSide = 65536;

struct Placed {
  WarpNode node;
  std::size_t column = 0;
  std::size_t row = 0;
};

Result<Placed> parse_node(const std::vector<std::string_view>& fields, const std::string& location) {
  if (fields.size() != kFields) {
    return fault(location, fmt::format("{} fields, and a node has {}", fields.size(), kFields),
                 "give x;y;u;v;column;row");
  }
  std::array<double, 4> values{};
  for (std::size_t i = 0; i < values.size(); ++i) {
    TRY_ASSIGN(values[i], number_of(fields[i], location));
  }
  std::array<std::size_t, 2> indices{};
  for (std::size_t i = 0; i < indices.size(); ++i) {
    const auto index = parse_integer(fields[4 + i]);
    if (!index || *index < 0 || *index >= kMaxSide) {
      return fault(location, fmt::format("'{}' is no column or row", printable(fields[4 + i])), "count them from 0");
    }
    indices[i] = static_cast<std::size_t>(*index);
  }
  return Placed{{values[0], 1.0 - values[1], values[2], 1.0 - values[3], 1.0}, indices[0], indices[1]};
}

}  // namespace

Result<WarpNet> parse_domeprojection(std::string_view text) {
  TextLines lines(text);
  std::vector<Placed> placed;
  std::vector<std::string> positions;
  std::size_t columns = 0;
  std::size_t rows = 0;
  bool is_first = true;
  while (const auto line = lines.next()) {
    const auto fields = fields_of(*line, ';');
    const bool is_header = is_first && !parse_double(fields[0]);
    is_first = false;
    if (is_header) continue;
    TRY_ASSIGN(const Placed node, parse_node(fields, lines.location()));
    if (placed.size() == kMaxWarpNodes) {
      return fault(lines.location(), fmt::format("more than {} nodes", kMaxWarpNodes), "export a coarser mesh");
    }
    columns = std::max(columns, node.column + 1);
    rows = std::max(rows, node.row + 1);
    placed.push_back(node);
    positions.push_back(lines.location());
  }
  if (columns < 2 || rows < 2 || columns * rows > kMaxWarpNodes || columns * rows < placed.size()) {
    return fault("end", fmt::format("{} nodes for {} columns and {} rows", placed.size(), columns, rows),
                 "give a grid of at least 2x2, each node once");
  }
  WarpNet net;
  net.columns = static_cast<int>(columns);
  net.rows = static_cast<int>(rows);
  net.nodes.resize(columns * rows);
  std::vector<bool> filled(columns * rows);
  for (std::size_t i = 0; i < placed.size(); ++i) {
    const std::size_t at = placed[i].row * columns + placed[i].column;
    if (filled[at]) {
      return fault(positions[i], fmt::format("column {} of row {} is there twice", placed[i].column, placed[i].row),
                   "give each node once");
    }
    filled[at] = true;
    net.nodes[at] = placed[i].node;
  }
  if (const auto gap = std::find(filled.begin(), filled.end(), false); gap != filled.end()) {
    const auto at = static_cast<std::size_t>(gap - filled.begin());
    return fault("end", fmt::format("column {} of row {} is missing", at % columns, at / columns),
                 "copy or export the mesh again");
  }
  TRY(check(net));
  return net;
}

}  // namespace cyclorama::interchange
