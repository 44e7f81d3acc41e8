// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <map>
#include <string>

#include "common/base/clock.h"
#include "common/image/jpeg.h"
#include "renderfarm/node/node_link.h"

namespace cyclorama::node {

/// Encodes rendered tiles into reports and adds up the cost of encoding. Bound to the send thread, which encodes one
/// tile while the render thread renders the next.
class TileSender {
 public:
  /// Returns the report for an item. Items must come in the order of the link's queue: the tiles of a block, then its
  /// end.
  wire::NodeReport report_of(NodeLink::Outgoing item);

 private:
  wire::NodeReport encoded(const RenderedTile& tile);
  wire::NodeReport end_of(const RenderedBlock& block);

  struct Encoding {
    double cpu_seconds = 0.0;
    std::string error{};
  };

  JpegEncoder encoder_;
  std::map<std::uint64_t, Encoding> blocks_;  ///< Blocks whose end has not come yet; their tiles may alternate.
};

}  // namespace cyclorama::node
