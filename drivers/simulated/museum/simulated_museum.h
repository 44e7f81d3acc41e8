// SPDX-License-Identifier: Apache-2.0
/// A museum that does not exist, with the devices that a calibration uses: projectors that show pictures, a turntable
/// with a camera on it. It has true optics, and keeps the truth to itself.
///
///     show(i, picture) ──▶ projector i ── light ──▶ wall ⇄ wall ──▶ camera ──▶ photograph_grey(exposure)
///                                                                     │
///                                             turn_to(angle) ──▶ turntable
///
/// Time is its own: it passes while the turntable turns, while the camera exposes and in wait(), and nowhere else.
/// The same calls in the same order give the same photographs, to the bit, on however many threads.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>

#include "common/base/result.h"
#include "common/image/image.h"
#include "common/room/installation.h"

namespace cyclorama::simulated {

struct MuseumTruth;
class TrueMuseum;

using GreyPhotograph = Image<std::uint16_t, 1>;  ///< Codes of camera_bits().
using RgbPhotograph = Image<std::uint16_t, 3>;

/// To 8 bits, the darkest code 0 and the brightest 255.
[[nodiscard]] GreyImage to_8_bits(const GreyPhotograph& photograph, int bits);
[[nodiscard]] RgbImage to_8_bits(const Image<std::uint16_t, 3>& photograph, int bits);

/// Thread-bound.
class SimulatedMuseum {
 public:
  /// Errors as TrueMuseum::make().
  static Result<SimulatedMuseum> make(Installation installation, const MuseumTruth& truth, int threads = 2);
  /// installation.toml, and the truth that lies beside it. Errors as read_installation().
  static Result<SimulatedMuseum> open(const std::filesystem::path& installation, int threads = 2);
  SimulatedMuseum(SimulatedMuseum&&) noexcept;
  SimulatedMuseum& operator=(SimulatedMuseum&&) noexcept;
  ~SimulatedMuseum();

  /// What an installer would have written, not the truth.
  [[nodiscard]] const Installation& installation() const;
  [[nodiscard]] std::size_t projector_count() const;

  /// The light follows after the projector's latency. An empty picture turns the lamp off. At first all are off.
  /// kInvalidArgument  no such projector, or a picture of another size than it has.
  Status show(std::size_t projector, RgbImage picture);
  /// Waits until all projectors show what they were told.
  void settle();
  void wait(double seconds);
  [[nodiscard]] double now_s() const;

  /// Positive to the right. Waits until it stands; where it really stands it does not know.
  void turn_to(double angle_rad);
  /// As the turntable believes.
  [[nodiscard]] double turntable_angle_rad() const;

  [[nodiscard]] int camera_width_px() const;
  [[nodiscard]] int camera_height_px() const;
  [[nodiscard]] int camera_bits() const;
  /// Of the camera without its colour filters, and with them. Begins at once: a row that is exposed while a projector
  /// changes sees some of both pictures. kInvalidArgument  an exposure that is not between 1 us and 1 min.
  Result<GreyPhotograph> photograph_grey(double exposure_s);
  Result<RgbPhotograph> photograph_colour(double exposure_s);

  /// For scoring, with drivers/simulated/museum/true_museum.h.
  [[nodiscard]] const TrueMuseum& truth() const;
  /// Where the turntable really stands. For scoring.
  [[nodiscard]] double true_turntable_angle_rad() const;

 private:
  struct State;
  explicit SimulatedMuseum(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

}  // namespace cyclorama::simulated
