// SPDX-License-Identifier: Apache-2.0
/// Gaussian splats: soft ellipsoids with a colour for each direction, trained from photographs. Their colours contain
/// the light under which the photographs were taken. Source: Kerbl et al., "3D Gaussian Splatting for Real-Time
/// Radiance Field Rendering", 2023.
#pragma once

#include <Eigen/Geometry>
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace cyclorama::scene {

inline constexpr int kMaxSplatDegree = 3;

/// A value. Invariants: all vectors have one entry for each splat (`coefficients` one for each coefficient of each
/// splat), all numbers are finite, scales and opacities are positive, opacities are at most 1, and rotations are unit
/// quaternions.
struct SplatCloud {
  std::string name;
  Eigen::Vector3d origin = Eigen::Vector3d::Zero();  ///< Added in double to every position.
  std::vector<std::array<float, 3>> positions;
  std::vector<std::array<float, 3>> scales;     ///< Standard deviations along the splat's axes.
  std::vector<std::array<float, 4>> rotations;  ///< w, x, y, z; from the splat's axes to the cloud's.
  std::vector<float> opacities;                 ///< Opacity at the centre.
  int degree = 0;                               ///< Degree of the spherical harmonics, 0 to kMaxSplatDegree.
  /// RGB for each coefficient of each splat, sorted by degree and then by order, with the signs of the original
  /// program.
  std::vector<std::array<float, 3>> coefficients;
  bool is_linear = false;  ///< Colours are blended as linear light instead of sRGB code values, which are usual.
  Eigen::Affine3d T_model_cloud = Eigen::Affine3d::Identity();

  [[nodiscard]] std::size_t size() const { return positions.size(); }
  [[nodiscard]] std::size_t coefficient_count() const {
    const auto side = static_cast<std::size_t>(degree) + 1;
    return side * side;
  }
  [[nodiscard]] std::size_t memory_bytes() const;
};

/// Returns the memory of one splat of the given degree.
[[nodiscard]] std::size_t bytes_per_splat(int degree);

/// Values of one splat, decoded from a file.
struct SplatValues {
  Eigen::Vector3d position = Eigen::Vector3d::Zero();
  Eigen::Vector3d scale = Eigen::Vector3d::Ones();
  Eigen::Quaterniond rotation = Eigen::Quaterniond::Identity();
  double opacity = 1.0;
};

/// Adds a splat with as many coefficients as the cloud's degree has. Returns false, and adds nothing, if a number is
/// not finite, a scale is not positive, the rotation is zero, or the splat is invisible.
bool add_splat(const SplatValues& values, std::span<const std::array<float, 3>> coefficients, SplatCloud* cloud);

/// Returns the sentence for Model::notes; empty if no splat was left out.
[[nodiscard]] std::string note_of_left_out(std::size_t left_out);

/// Returns the box of the splats in the model's frame; empty if there are none. Excludes the outermost half percent on
/// each side, because training leaves stray splats far away.
[[nodiscard]] Eigen::AlignedBox3d bounds_of(const SplatCloud& cloud);

struct Mesh;
/// Returns small squares at the centres of some opaque splats, up to about 100,000, in the model's frame. They stand
/// for the splats where surfaces are needed, as in the search for a standing position.
[[nodiscard]] Mesh shape_of(std::span<const SplatCloud> clouds);

/// Change of colour per unit of the coefficient of degree 0; a coefficient of 0 gives a colour of 0.5.
inline constexpr double kSplatColourScale = 0.28209479177387814;
[[nodiscard]] inline float coefficient_of(double colour) {
  return static_cast<float>((colour - 0.5) / kSplatColourScale);
}

}  // namespace cyclorama::scene
