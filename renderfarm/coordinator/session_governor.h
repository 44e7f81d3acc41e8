// SPDX-License-Identifier: Apache-2.0
/// The quality of the pictures of a session with a frame budget.
#pragma once

#include <string>

#include "common/base/clock.h"
#include "common/wire/view.pb.h"
#include "renderfarm/coordinator/governed.h"
#include "renderfarm/coordinator/session.h"

namespace cyclorama::coordinator {

/// Returns the size of a view's picture in millions of pixels.
[[nodiscard]] double megapixels(const wire::View& view);

/// Sets a view's quality settings, with the number of bounces of the session's pictures, and multiplies its panorama's
/// size by the quality's scale, rounded to multiples of 16.
void apply(const GovernorState& governed, render::PictureQuality quality, wire::View* view);

/// Chooses the quality of a moving picture.
void govern(GovernorState& governed, FrameInFlight* frame);

/// Updates the governor from a frame that the museum has taken.
void learn(GovernorState& governed, const WrittenFrame& frame, TimePoint now);

/// Gives the session's governor another Pareto front; `fresh` is a governor that has it. A picture at rest continues
/// unchanged.
void change_front(Session& session, std::unique_ptr<GovernorState> fresh);

/// Returns a few words for the operator; empty if the session is not governed or has requested nothing yet.
[[nodiscard]] std::string quality_summary(const Session& session);

}  // namespace cyclorama::coordinator
