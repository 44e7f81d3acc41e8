// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "common/base/clock.h"
#include "common/image/jpeg.h"
#include "renderfarm/node/node_link.h"

namespace cyclorama {

/// Turns what was rendered into what is sent, and adds up what the encoding costs. Thread-bound: the send thread's,
/// which encodes one tile while the render thread makes the next.
class TileSender {
 public:
  /// Takes items in the order of the link's queue: a block's tiles, then its end.
  wire::NodeReport report_of(NodeLink::Outgoing item);

 private:
  wire::NodeReport encoded(const RenderedTile& tile);
  wire::NodeReport end_of(const RenderedBlock& block);

  JpegEncoder encoder_;
  double encode_cpu_seconds_ = 0.0;  ///< Of the block whose tiles come now.
  std::string error_;                ///< Likewise.
};

}  // namespace cyclorama
