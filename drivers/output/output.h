// SPDX-License-Identifier: Apache-2.0
/// Where pictures leave the computer: the heads of a graphics card, or pictures in memory.
///
///   for (;;) {
///     TRY(output.wait_for_refresh());                 // Paces the loop.
///     for (each head) { TRY(output.draw_to(head)); ... GLES calls ... }
///     TRY_ASSIGN(Presented p, output.present());      // All heads in one flip.
///   }
///
/// Every kind has an option `is_awake`: while that is false the heads are dark (DPMS), refreshes go on, and what is
/// drawn is kept; on waking the newest picture of each head is shown without being drawn again.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "common/base/clock.h"
#include "common/base/result.h"
#include "drivers/output/gl.h"

namespace cyclorama::output {

struct HeadMode {
  std::string name;  ///< The projector that hangs on it, as in installation.toml.
  int width_px = 0;
  int height_px = 0;
};

struct Presented {
  std::uint64_t refresh = 0;  ///< Counts refreshes since the start; a gap shows missed ones.
  TimePoint at{};             ///< When the heads began to show it.
};

/// What one head did at the last present().
struct HeadShown {
  enum class Light {
    kDark,  ///< Nobody sees it: no projector, asleep, or it failed.
    kSame,  ///< Nothing new was drawn.
    kNew,
  };
  Light light = Light::kDark;
  TimePoint at{};           ///< kNew: when it began to show the picture.
  double refresh_hz = 0.0;  ///< Its own mode's, unless it is dark.
  int depth_bits = 8;       ///< Of the code values that it shows, each channel, unless it is dark.
};

/// Owned by the display's present thread, which also owns the GL context that the output made current. Thread-bound.
class Output {
 public:
  virtual ~Output() = default;

  [[nodiscard]] virtual const std::vector<HeadMode>& heads() const = 0;
  [[nodiscard]] virtual double refresh_hz() const = 0;
  /// For people: "headless EGL", "DRM /dev/dri/card0".
  [[nodiscard]] virtual std::string kind() const = 0;
  /// The calls of the context that is current on this thread; lives as long as the output.
  [[nodiscard]] virtual const Gl& gl() const = 0;

  /// Blocks until it is time to draw the next picture. kUnavailable  the output is lost; make a new one.
  virtual Status wait_for_refresh() = 0;
  /// Binds the framebuffer of heads()[head] and sets the viewport. Rows count from the bottom, as in GL; it takes
  /// sRGB code values as they are (no conversion by the framebuffer).
  virtual Status draw_to(std::size_t head) = 0;
  /// Shows what was drawn on all heads at once. Heads that were not drawn keep their picture.
  virtual Result<Presented> present() = 0;
  /// One for each of heads(); of the last present(). Lives as long as the output.
  [[nodiscard]] virtual const std::vector<HeadShown>& shown() const = 0;

 protected:
  Output() = default;
  Output(const Output&) = delete;
  Output& operator=(const Output&) = delete;
};

}  // namespace cyclorama::output
