// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "common/base/clock.h"
#include "common/image/jpeg.h"
#include "renderfarm/node/node_link.h"
#include "renderfarm/render/crew.h"

namespace cyclorama::node {

/// Encodes rendered tiles into reports and adds up the cost of encoding. Bound to the send thread, which encodes tiles
/// with the crew's help while the next are rendered. Keeps a reference to the crew.
class TileSender {
 public:
  explicit TileSender(render::Crew& crew) : crew_(crew) {}

  /// Returns the reports for some items. Items must come in the order of the link's queue: the tiles of a block, then
  /// its end.
  std::vector<wire::NodeReport> reports_of(std::vector<NodeLink::Outgoing> items);

 private:
  wire::NodeReport end_of(const RenderedBlock& block);

  struct Encoding {
    double cpu_seconds = 0.0;
    std::string error{};
  };

  render::Crew& crew_;
  std::vector<JpegEncoder> encoders_;         ///< One for each item of the most at once.
  std::map<std::uint64_t, Encoding> blocks_;  ///< Blocks whose end has not come yet; their tiles may alternate.
};

}  // namespace cyclorama::node
