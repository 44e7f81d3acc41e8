// SPDX-License-Identifier: Apache-2.0
/// The room that the show's own devices stand in: projectors that show what they are told, and a fixed camera beside
/// each. It has true optics, and keeps the truth to itself; SimulatedShow is its inside.
///
/// Somebody bumps a projector by replacing the file of the truth beside installation.toml: whoever takes the next
/// photograph sees it.
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
    int wall_cells = 24;  ///< That throw light at each other.
    int threads = 1;
  };
  /// What its maker's data sheet and a chessboard would have told of a camera.
  struct Lens {
    int width_px = 0;
    int height_px = 0;
    double focal_px = 0.0;
    double centre_u_px = 0.0;
    double centre_v_px = 0.0;
    double radial[3] = {};
    double tangential[2] = {};
  };

  /// Errors as SimulatedMuseum::open().
  static Result<SimulatedStage> open(const std::filesystem::path& installation, const Options& options);
  SimulatedStage(SimulatedStage&&) noexcept;
  SimulatedStage& operator=(SimulatedStage&&) noexcept;
  ~SimulatedStage();

  [[nodiscard]] std::size_t camera_count() const;
  [[nodiscard]] Lens lens(std::size_t camera) const;  ///< Precondition: there is such a camera.
  /// Of the projector's size, or smaller by a whole number each way: then it is made larger. Empty: the lamp is off.
  /// kInvalidArgument  no such projector, or another size.
  Status show(std::size_t projector, const RgbImage& picture);
  /// Grey codes of 8 bits. kInvalidArgument  no such camera. kBadData  the truth's file was replaced by one that is
  /// none.
  Result<GreyImage> photograph(std::size_t camera, double exposure_s);

 private:
  struct State;
  explicit SimulatedStage(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

}  // namespace cyclorama::simulated
