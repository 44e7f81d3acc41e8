// SPDX-License-Identifier: Apache-2.0
/// Plain data of CoordinatorState: the state of a session with a frame budget.
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

/// A part of a picture, assigned to a node. During refinement the parts stay at their nodes, which hold the sample
/// sums.
struct AssignedBlock {
  NodeId node{};
  PixelRect rect;
  BlockForecast forecast{};
};

struct GovernorState {
  GovernorState(governor::Governor by, int samples, std::optional<int> all_bounces)
      : governor(std::move(by)), reference_samples(samples), bounces(all_bounces) {}

  governor::Governor governor;
  int reference_samples = 0;
  /// Number of bounces of all pictures, so that brightness does not depend on quality. A view with a number above 0
  /// overrides it. Null: the number of the scene's measured Pareto front.
  std::optional<int> bounces{};
  std::optional<wire::View> asked{};  ///< The last planned view, as requested by the museum.
  TimePoint written_at{};             ///< Time when the museum last took a complete frame.
  TimePoint still_since{};            ///< The later of written_at and the last request.
  /// Set from the first refined picture until another view arrives.
  std::optional<governor::Refinement> refinement{};
  std::string light{};  ///< Version of the light that pictures at rest use, once there is a refinement.
  std::vector<AssignedBlock> blocks{};
  int failures = 0;            ///< Number of consecutive refined pictures that were given up.
  TimePoint retry_at{};        ///< Earliest time of the next attempt.
  double ms_per_sample = 0.0;  ///< Milliseconds per sample and megapixel, at rest; 0: unknown.
};

}  // namespace cyclorama::coordinator
