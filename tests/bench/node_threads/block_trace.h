// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "common/base/result.h"

namespace cyclorama {

/// The time that each part of a block takes on one thread, in the order in which a crew computes them.
struct BlockTrace {
  struct Step {
    double serial_seconds = 0.0;  ///< Work of the block's own thread before the cells.
    std::vector<float> cells{};
  };
  std::vector<Step> rendering{};
  double rest_seconds = 0.0;      ///< Work of the block's own thread after the last step.
  std::vector<float> encoding{};  ///< Its tiles as JPEG, which the send thread requests.

  [[nodiscard]] double seconds() const;
};

struct TracedPicture {
  int width_px = 1920;
  int height_px = 1080;
  int samples = 4;
  bool denoise = true;
  bool stored_light = false;
};

/// Renders `views` pictures of a scene as blocks of a node of so many threads, from several eyes around its start, and
/// returns how long each cell took. The real code runs, on one thread. Errors: those of loading the scene.
Result<std::vector<BlockTrace>> traced_blocks(const std::string& scene, const TracedPicture& picture, int views,
                                              int threads);

}  // namespace cyclorama
