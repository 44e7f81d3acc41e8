// SPDX-License-Identifier: Apache-2.0
#include "kiosk/operator/frame_stages.h"

#include <algorithm>

namespace cyclorama::operations {

std::vector<wire::Stage> in_frame_order(const wire::ProcessStatus& tour) {
  std::vector<wire::Stage> stages(tour.stages().begin(), tour.stages().end());
  const auto place = [](const wire::Stage& stage) {
    return std::find_if(kFrameStages.begin(), kFrameStages.end(),
                        [&](const FrameStage& known) { return known.name == stage.name(); }) -
           kFrameStages.begin();
  };
  std::stable_sort(stages.begin(), stages.end(),
                   [&](const wire::Stage& a, const wire::Stage& b) { return place(a) < place(b); });
  return stages;
}

}  // namespace cyclorama::operations
