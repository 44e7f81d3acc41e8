// SPDX-License-Identifier: Apache-2.0
/// What the coordinator remembers of a session that gave a frame budget: plain data of CoordinatorState.
#pragma once

#include <optional>
#include <utility>
#include <vector>

#include "common/base/clock.h"
#include "common/image/pixel_rect.h"
#include "common/wire/view.pb.h"
#include "renderfarm/coordinator/frame_assembly.h"
#include "renderfarm/coordinator/ids.h"
#include "renderfarm/governor/governor.h"
#include "renderfarm/governor/refinement.h"

namespace cyclorama::coordinator {

/// Where a part of a picture is made. While it is refined the parts stay where they are: the sums are there.
struct AssignedBlock {
  NodeId node{};
  PixelRect rect;
  BlockForecast forecast{};
};

struct GovernorState {
  GovernorState(governor::Governor by, int samples) : governor(std::move(by)), reference_samples(samples) {}

  governor::Governor governor;
  int reference_samples = 0;
  std::optional<wire::View> asked{};  ///< The last that was planned, as the museum asked.
  std::size_t point = 0;              ///< Of the front: what it was planned at.
  TimePoint written_at{};             ///< When the museum last took a whole frame.
  TimePoint still_since{};            ///< The same, or when it last asked for something.
  /// From the first refined picture on, until another view comes.
  std::optional<governor::Refinement> refinement{};
  std::vector<AssignedBlock> blocks{};
  int failures = 0;            ///< Refined pictures given up one after the other: what is shown stays.
  TimePoint retry_at{};        ///< Not before.
  double ms_per_sample = 0.0;  ///< And megapixel, at rest; 0: not known.
};

/// Fills a view's knobs and shrinks its panorama by the quality's scale, to multiples of 16.
void apply(const render::PictureQuality& quality, wire::View* view);

}  // namespace cyclorama::coordinator
