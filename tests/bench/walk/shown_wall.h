// SPDX-License-Identifier: Apache-2.0
/// What a wall shows of a frame: the display's own passes, drawn by GL in memory and read back.
#pragma once

#include <memory>
#include <optional>

#include "appliance/display/frame_light.h"
#include "appliance/display/head_painter.h"
#include "drivers/output/output.h"

namespace cyclorama {

/// One head that shows exactly the wall's picture, pixel by pixel. Thread-bound to its GL context.
class ShownWall {
 public:
  /// Errors: those of the headless output, and of the painters.
  /// `filter`: nothing as this machine's display chooses it; kSharp with light as cards have it.
  static Result<std::unique_ptr<ShownWall>> make(const PictureShape& wall, std::optional<display::MeshFilter> filter);

  /// Takes a frame, which has a guard band around the wall's picture; if `reuses`, with what earlier ones showed.
  Status take(const display::DisplayFrame& frame, bool reuses);
  /// Draws the newest frame for a visitor at `eye_m` (Scene frame) with that heading; from its own eye if `moves` is
  /// false or the frame has no mesh.
  Result<RgbImage> shown(const Eigen::Vector3d& eye_m, double heading_rad, bool moves);
  /// Draws the frame's light alone, as it came or moved by `eye_m` (Eye frame), and waits until the card is done; for
  /// timing, like finish().
  Status convert(const Eigen::Vector3d& eye_m);
  Status finish();
  /// GL's name of its renderer.
  [[nodiscard]] const std::string& renderer() const { return renderer_; }

 private:
  explicit ShownWall(const PictureShape& wall) : wall_(wall) {}
  Status draw_for(const Eigen::Vector3d& eye_m, double heading_rad, bool moves);

  PictureShape wall_;
  SteadyClock clock_;
  std::string renderer_;
  std::unique_ptr<output::Output> output_;
  std::optional<display::PictureProgram> program_;
  std::optional<display::HeadPrograms> programs_;
  std::optional<display::HeadPainter> painter_;
  std::optional<display::FrameLight> light_;
  display::DisplayFrame frame_;
};

}  // namespace cyclorama
