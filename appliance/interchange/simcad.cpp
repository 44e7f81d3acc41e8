// SPDX-License-Identifier: Apache-2.0
#include <cmath>

#include "appliance/interchange/mesh_files.h"
#include "appliance/interchange/text_lines.h"
#include "appliance/interchange/xml_reader.h"

namespace cyclorama::interchange {
namespace {

constexpr std::size_t kXmlLimitBytes = std::size_t{64} << 20;

/// Returns the offsets along one axis, as shares of the picture.
Result<std::vector<double>> offsets_in(const XmlElement& definition, std::string_view name) {
  TRY_ASSIGN(const XmlElement element, definition.child(name));
  TRY_ASSIGN(const double range, element.number_attribute("range"));
  if (!(range > 0.0))
    return fault(element.location(), "its range is not above 0", "give the offset of one whole picture");
  const std::string text = element.text();
  std::vector<double> offsets;
  TextLines lines(text);
  while (const auto line = lines.next()) {
    for (const std::string_view field : fields_of(*line)) {
      TRY_ASSIGN(const double value, number_of(field, element.location()));
      offsets.push_back(value / range);
      if (offsets.size() > kMaxWarpNodes) {
        return fault(element.location(), fmt::format("more than {} nodes", kMaxWarpNodes), "export a coarser grid");
      }
    }
  }
  return offsets;
}

}  // namespace

Result<WarpNet> parse_simcad(std::string_view text) {
  TRY_ASSIGN(const std::unique_ptr<XmlDocument> document, XmlDocument::parse(text, "SimCAD", kXmlLimitBytes));
  TRY_ASSIGN(const XmlElement root, document->root("GeometryFile"));
  TRY_ASSIGN(const XmlElement definition, root.child("GeometryDefinition"));
  TRY_ASSIGN(const std::vector<double> right, offsets_in(definition, "X-FlatParameters"));
  TRY_ASSIGN(const std::vector<double> down, offsets_in(definition, "Y-FlatParameters"));
  const auto side = static_cast<std::size_t>(std::lround(std::sqrt(static_cast<double>(right.size()))));
  if (right.size() != down.size() || side < 2 || side * side != right.size()) {
    return fault(definition.location(),
                 fmt::format("{} offsets to the right and {} down make no square grid", right.size(), down.size()),
                 "copy or export the file again");
  }
  WarpNet net;
  net.columns = static_cast<int>(side);
  net.rows = static_cast<int>(side);
  for (std::size_t i = 0; i < right.size(); ++i) {
    const double u = static_cast<double>(i % side) / static_cast<double>(side - 1);
    const double v = 1.0 - static_cast<double>(i / side) / static_cast<double>(side - 1);
    net.nodes.push_back({u + right[i], v - down[i], u, v, 1.0});
  }
  TRY(check(net));
  return net;
}

}  // namespace cyclorama::interchange
