// SPDX-License-Identifier: Apache-2.0
/// The room in which the show's simulated devices stand: projectors that show pictures, and a fixed camera beside each.
/// It is built on SimulatedShow and does not expose the truth.
///
/// To bump a projector, replace the truth's file beside installation.toml: the next photograph uses the new file.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <vector>

#include "common/base/result.h"
#include "common/image/image.h"

namespace cyclorama::simulated {

/// Thread-safe.
class SimulatedStage {
 public:
  struct Options {
    double camera_megapixels = 0.3;
    double camera_field_deg = 80.0;
    int wall_cells = 24;  ///< Number of wall cells for inter-reflection.
    int threads = 1;
  };
  /// Intrinsics of a camera, as its data sheet and a chessboard would give them.
  struct Lens {
    int width_px = 0;
    int height_px = 0;
    double focal_px = 0.0;
    double centre_u_px = 0.0;
    double centre_v_px = 0.0;
    double radial[3] = {};
    double tangential[2] = {};
  };

  /// Errors: those of SimulatedMuseum::open().
  static Result<SimulatedStage> open(const std::filesystem::path& installation, const Options& options);
  SimulatedStage(SimulatedStage&&) noexcept;
  SimulatedStage& operator=(SimulatedStage&&) noexcept;
  ~SimulatedStage();

  [[nodiscard]] std::size_t camera_count() const;
  [[nodiscard]] Lens lens(std::size_t camera) const;  ///< Precondition: there is such a camera.
  /// `picture` has the projector's size, or that size divided by a whole number; it is then enlarged. An empty picture
  /// turns the lamp off. Errors: kInvalidArgument if there is no such projector, or the picture has another size.
  Status show(std::size_t projector, const RgbImage& picture);
  /// Returns grey codes of 8 bits. Errors: kInvalidArgument if there is no such camera; kBadData if the truth's file
  /// was replaced by an invalid one.
  Result<GreyImage> photograph(std::size_t camera, double exposure_s);

 private:
  struct State;
  explicit SimulatedStage(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

}  // namespace cyclorama::simulated
