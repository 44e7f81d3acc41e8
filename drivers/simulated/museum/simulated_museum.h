// SPDX-License-Identifier: Apache-2.0
/// A simulated museum with the devices that a calibration uses: projectors that show pictures, and a turntable with a
/// camera. Its optics have flaws, and its users get only photographs, not the truth.
///
///     show(i, picture) ──▶ projector i ── light ──▶ wall ⇄ wall ──▶ camera ──▶ photograph_grey(exposure)
///                                                                     │
///                                             turn_to(angle) ──▶ turntable
///
/// It has its own clock, which advances only while the turntable turns, while the camera exposes and in wait().
/// The same calls in the same order give bit-identical photographs, for any number of threads.
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

/// Converts to 8 bits: the darkest code becomes 0 and the brightest 255.
[[nodiscard]] GreyImage to_8_bits(const GreyPhotograph& photograph, int bits);
[[nodiscard]] RgbImage to_8_bits(const Image<std::uint16_t, 3>& photograph, int bits);

/// Thread-bound.
class SimulatedMuseum {
 public:
  /// Errors: those of TrueMuseum::make().
  static Result<SimulatedMuseum> make(Installation installation, const MuseumTruth& truth, int threads = 2);
  /// Opens installation.toml and the truth beside it. Errors: those of read_installation().
  static Result<SimulatedMuseum> open(const std::filesystem::path& installation, int threads = 2);
  SimulatedMuseum(SimulatedMuseum&&) noexcept;
  SimulatedMuseum& operator=(SimulatedMuseum&&) noexcept;
  ~SimulatedMuseum();

  /// The installation as an installer would describe it, not the truth.
  [[nodiscard]] const Installation& installation() const;
  [[nodiscard]] std::size_t projector_count() const;

  /// Shows a picture; its light arrives after the projector's latency. An empty picture turns the lamp off. Initially
  /// all lamps are off. Errors: kInvalidArgument if there is no such projector, or the picture has another size.
  Status show(std::size_t projector, RgbImage picture);
  /// Waits until all projectors show their latest pictures.
  void settle();
  void wait(double seconds);
  [[nodiscard]] double now_s() const;

  /// Turns to an angle, positive to the right, and waits until the turntable stands still. The true angle differs
  /// slightly.
  void turn_to(double angle_rad);
  /// Nominal angle of the turntable.
  [[nodiscard]] double turntable_angle_rad() const;

  [[nodiscard]] int camera_width_px() const;
  [[nodiscard]] int camera_height_px() const;
  [[nodiscard]] int camera_bits() const;
  /// Takes a photograph with the camera, without or with its colour filters. The exposure begins at once: a row that is
  /// exposed while a projector changes sees some of both pictures. Errors: kInvalidArgument if the exposure is not
  /// between 1 us and 1 min.
  Result<GreyPhotograph> photograph_grey(double exposure_s);
  Result<RgbPhotograph> photograph_colour(double exposure_s);

  /// Returns the truth, for scoring; see true_museum.h.
  [[nodiscard]] const TrueMuseum& truth() const;
  /// True angle of the turntable. For scoring.
  [[nodiscard]] double true_turntable_angle_rad() const;

 private:
  struct State;
  explicit SimulatedMuseum(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

}  // namespace cyclorama::simulated
