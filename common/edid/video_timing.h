// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

namespace cyclorama {

/// One direction of a video timing: what is visible, and the blanking after it. In pixels, or in lines.
struct TimingAxis {
  int visible = 0;
  int front_porch = 0;
  int sync = 0;
  int back_porch = 0;
  bool is_sync_positive = false;
  [[nodiscard]] int total() const { return visible + front_porch + sync + back_porch; }
  friend bool operator==(const TimingAxis&, const TimingAxis&) = default;
};

/// A video signal that a projector accepts. A value; reentrant.
struct VideoTiming {
  int clock_khz = 0;
  TimingAxis horizontal;
  TimingAxis vertical;  ///< Interlaced: `visible` counts the lines of both fields, the blanking those of one.
  bool is_interlaced = false;
  bool is_preferred = false;  ///< The projector's own size.

  /// Returns pictures per second, or fields if interlaced; 0 for a timing without pixels.
  [[nodiscard]] double refresh_hz() const;
  /// Returns whether a graphics card could make this signal: 5 to 1000 Hz, with sync pulses, at most 65535 pixels and
  /// lines in all.
  [[nodiscard]] bool is_possible() const;
  friend bool operator==(const VideoTiming&, const VideoTiming&) = default;
};

/// Returns the timing for this size and rate by VESA's Coordinated Video Timings 1.2: with the blanking of cathode ray
/// tubes, or with the reduced one of version 1 of that formula. Precondition: positive values; an impossible timing may
/// result.
[[nodiscard]] VideoTiming coordinated_timing(int width_px, int height_px, double refresh_hz, bool is_reduced);

}  // namespace cyclorama
