// SPDX-License-Identifier: Apache-2.0
/// Judges a recording and writes it to a folder.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "common/base/result.h"
#include "kiosk/operator/recording.h"

namespace cyclorama::operations {

struct RecordedSpan {
  double seconds = 0.0;
  double frames = 0.0;         ///< Frames presented within the recording.
  double poses = 0.0;          ///< Refreshes within the recording that showed a new pose.
  double frames_wanted = 1.0;  ///< Minimum number of frames; fewer are a problem.
  /// Time from the start that the caller named to the first presented frame.
  std::optional<double> first_picture_s;
};

/// Returns one sentence for each part that did not work: no or too few frames; a picture that is missing, blank or
/// (wall, panorama) frozen; a process away or unhealthy; no pose. Empty when everything worked.
[[nodiscard]] std::vector<std::string> problems_of(const Recording& recording, const RecordedSpan& span);

/// Returns { scene, title, triangles, nodes, seconds, frames, fps, shown_hz, eye_missed_m, scale, samples, wasted,
///   bytes_per_frame, balance_efficiency, first_picture_s,
///   stages: { name: { p50_ms, p95_ms, p99_ms, count } }, drops: { reason: count },
///   processes: { name: { state, healthy } }, ok, problems: [] }
///
/// stages: from shutter to photon; nodes: the nodes that the farm has, even if few of them rendered the last frame;
/// shown_hz: refreshes that showed a new pose, per second; eye_missed_m: distance between the visitor and the eye of
/// the picture; scale: width of a moving frame divided by the requested width; wasted: share of the views whose frame
/// was rendered and not shown.
[[nodiscard]] std::string summary_json(const Recording& recording, const RecordedSpan& span,
                                       const std::vector<std::string>& problems);

/// Writes panorama.png, projector-NAME.png, wall.png, camera.png, wall-over-time.png and summary.json into a folder,
/// which is made if needed. Errors: kSystem if it cannot be written.
Status write_recording(const Recording& recording, const std::filesystem::path& folder, const std::string& summary);

}  // namespace cyclorama::operations
