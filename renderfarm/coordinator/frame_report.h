// SPDX-License-Identifier: Apache-2.0
/// What the operator and the museum get to know of a frame that is over.
#pragma once

#include "common/base/clock.h"
#include "common/wire/farm.pb.h"
#include "renderfarm/coordinator/delegate.h"
#include "renderfarm/coordinator/node_table.h"
#include "renderfarm/coordinator/session.h"

namespace cyclorama::coordinator {

/// Returns the report of a frame that ends at `now`.
[[nodiscard]] FrameReport report_of(SessionId id, const Session& session, const FrameInFlight& frame,
                                    const NodeTable& nodes, TimePoint now);
/// Returns the message that ends the frame.
[[nodiscard]] wire::FrameEnd end_of(const Session& session, const FrameInFlight& frame, const FrameReport& report);
/// Returns what is needed of the frame until its end has been written.
[[nodiscard]] WrittenFrame to_be_written(const FrameInFlight& frame, const FrameReport& report);

}  // namespace cyclorama::coordinator
