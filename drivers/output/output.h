// SPDX-License-Identifier: Apache-2.0
/// The device layer below the display: the heads of a graphics card, or pictures in memory.
///
///   for (;;) {
///     TRY(output.wait_for_refresh());                 // Paces the loop.
///     for (each head) { TRY(output.draw_to(head)); ... GLES calls ... }
///     TRY_ASSIGN(Presented p, output.present());      // All heads in one flip.
///   }
///
/// Every kind has an option `is_awake`: while it is false the heads are dark (DPMS), refreshes continue, and drawn
/// pictures are kept; on waking, the newest picture of each head is shown without being drawn again.
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
  std::string name;  ///< Name of the projector, as in installation.toml.
  int width_px = 0;
  int height_px = 0;
};

struct Presented {
  std::uint64_t refresh = 0;  ///< Refresh number since the start; a gap shows missed refreshes.
  TimePoint at{};             ///< Time at which the heads began to show the pictures.
};

/// State of one head after the last present().
struct HeadShown {
  enum class Light {
    kDark,  ///< Nothing visible: no projector, asleep, or failed.
    kSame,  ///< The picture is unchanged.
    kNew,
  };
  Light light = Light::kDark;
  TimePoint at{};           ///< For kNew, the time at which the head began to show the picture.
  double refresh_hz = 0.0;  ///< Rate of the head's mode; meaningless while dark.
  int depth_bits = 8;       ///< Bits per channel of the displayed code values; meaningless while dark.
};

/// Owned by the display's present thread, which also owns the GL context that the output made current. Thread-bound.
class Output {
 public:
  virtual ~Output() = default;

  [[nodiscard]] virtual const std::vector<HeadMode>& heads() const = 0;
  [[nodiscard]] virtual double refresh_hz() const = 0;
  /// Returns a name for people: "headless EGL", "DRM /dev/dri/card0".
  [[nodiscard]] virtual std::string kind() const = 0;
  /// GL calls of the context that is current on this thread; valid as long as the output exists.
  [[nodiscard]] virtual const Gl& gl() const = 0;

  /// Blocks until it is time to draw the next picture. Errors: kUnavailable if the output is lost; make a new one.
  virtual Status wait_for_refresh() = 0;
  /// Binds the framebuffer of heads()[head] and sets the viewport. Rows count from the bottom, as in GL; values written
  /// are sRGB codes, which the framebuffer does not convert.
  virtual Status draw_to(std::size_t head) = 0;
  /// Shows all drawn heads at once. Heads that were not drawn keep their picture.
  virtual Result<Presented> present() = 0;
  /// States after the last present(), one for each of heads(); the reference is valid as long as the output exists.
  [[nodiscard]] virtual const std::vector<HeadShown>& shown() const = 0;

 protected:
  Output() = default;
  Output(const Output&) = delete;
  Output& operator=(const Output&) = delete;
};

}  // namespace cyclorama::output
