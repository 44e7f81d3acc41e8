// SPDX-License-Identifier: Apache-2.0
/// Common model of other programs' calibrations of projectors: every format of this folder is read into it and written
/// from it. Source: VESA, "MPCDI" (multiple projection common data interchange) 1.0 (2013) and 2.0 (2015), whose terms
/// it uses.
///
///   WarpSet ─ buffers ─ regions: one projector each
///                        map         per sample, the source or target of the projector's light
///                        alpha       share of its light that a pixel gives (blend)
///                        beta        light that a pixel adds, so that black is uniform
///                        distortion  from an ideal lens to the real one (shader lamps)
///
/// All are values. Maps have their first row at the top; row and column i are at (i + 0.5) / count of the region, so
/// that the samples of a map of the projector's size are at the pixels' centres. NaN marks samples that are not mapped.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "common/base/result.h"
#include "common/image/image.h"

namespace cyclorama::interchange {

enum class MpcdiVersion { k1_0, k2_0 };

/// Contents of a region's map.
enum class WarpProfile {
  k2d,           ///< u, v in the region's part of the buffer's picture.
  k3d,           ///< u, v in the picture that the region's frustum sees.
  kAdvanced3d,   ///< x, y, z on the screen: right pictures for any eye.
  kShaderLamps,  ///< x, y, z on the object, and the projector's pose.
};

enum class LengthUnit { kUnknown, kMillimetre, kCentimetre, kDecimetre, kMetre, kInch, kFoot, kYard };
enum class DataOrigin { kUnknown, kIdealEyePoint, kFloorCentre, kCentreOfMass };
enum class WarpInterpolation { kUnknown, kLinear, kKeystone, kSmooth };

/// Returns metres per unit; empty for kUnknown.
[[nodiscard]] std::optional<double> metres_in(LengthUnit unit);

/// Three numbers per sample. Flat maps: u to the right and v UP from the lower left corner, 0 to 1; the third number is
/// an error or 0. Maps in space: x right, y up, z back (as in frame::Room), in the region's unit.
using WarpMap = Image<float, 3>;

/// Returns whether two maps are equal bit by bit; NaN equals NaN.
[[nodiscard]] bool same_bits(const WarpMap& a, const WarpMap& b);

/// A mask with the samples of its PNG, so that conversions lose nothing.
struct MaskMap {
  int width_px = 0;
  int height_px = 0;
  int channels = 1;  ///< 1 or 3 (red, green, blue).
  int bits = 16;     ///< 8 or 16.
  std::vector<std::uint16_t> samples;
  double gamma = 1.0;  ///< Light is (sample / largest()) to this power.

  MaskMap() = default;
  MaskMap(int width, int height, int channel_count, int bit_count);
  /// Returns the light of one pixel in [0, 1]; the mean of its channels. Precondition: the pixel is inside.
  [[nodiscard]] double light_at(int x, int y) const;
  [[nodiscard]] std::uint16_t largest() const { return bits == 8 ? 255 : 65535; }
  friend bool operator==(const MaskMap&, const MaskMap&) = default;
};

/// Rectangle of a region in the buffer's picture, from the lower left corner; the whole picture is 0 to 1.
struct RegionRect {
  double x = 0.0;
  double y = 0.0;
  double width = 1.0;
  double height = 1.0;
  friend bool operator==(const RegionRect&, const RegionRect&) = default;
};

/// Frustum of a region, in degrees. Starting from the view along -z with y up, the view is first turned to the right by
/// yaw, then up by pitch, then clockwise (as the viewer sees it) by roll. In a centred frustum, left and down are
/// negative.
struct WarpFrustum {
  double yaw_deg = 0.0;
  double pitch_deg = 0.0;
  double roll_deg = 0.0;
  double right_deg = 0.0;
  double left_deg = 0.0;
  double up_deg = 0.0;
  double down_deg = 0.0;
  friend bool operator==(const WarpFrustum&, const WarpFrustum&) = default;
};

/// Position of a projector, and the axes of the frustum's yaw, pitch and roll: unit vectors, usually down, right and
/// forward.
struct WarpCoordinateFrame {
  double position[3] = {0.0, 0.0, 0.0};
  double yaw[3] = {0.0, -1.0, 0.0};
  double pitch[3] = {1.0, 0.0, 0.0};
  double roll[3] = {0.0, 0.0, -1.0};
  friend bool operator==(const WarpCoordinateFrame&, const WarpCoordinateFrame&) = default;
};

struct WarpRegion {
  std::string id;
  int width_px = 0;  ///< Size of the projector's picture.
  int height_px = 0;
  RegionRect rect;
  std::optional<WarpFrustum> frustum;
  std::optional<WarpCoordinateFrame> coordinate_frame;
  std::optional<WarpMap> map;  ///< Absent if only the projector's pose is known.
  LengthUnit unit = LengthUnit::kUnknown;
  DataOrigin origin = DataOrigin::kUnknown;
  WarpInterpolation interpolation = WarpInterpolation::kLinear;
  std::optional<MaskMap> alpha;
  std::optional<MaskMap> beta;
  std::optional<WarpMap> distortion;

  friend bool operator==(const WarpRegion& a, const WarpRegion& b);
};

/// One picture that several regions share.
struct WarpBuffer {
  std::string id;
  int width_px = 0;  ///< 0 if not specified.
  int height_px = 0;
  std::vector<WarpRegion> regions;
  friend bool operator==(const WarpBuffer&, const WarpBuffer&) = default;
};

struct WarpSet {
  WarpProfile profile = WarpProfile::k2d;
  MpcdiVersion version = MpcdiVersion::k2_0;
  std::string date;      ///< Text of the file, unchanged.
  int level = 1;         ///< MPCDI 1.0: with beta maps in levels 2 and 4. MPCDI 2.0: level of the geometry.
  int colour_level = 1;  ///< MPCDI 2.0.
  std::vector<WarpBuffer> buffers;

  /// Returns the region with the id in any buffer; null if there is none.
  [[nodiscard]] const WarpRegion* region(const std::string& id) const;
  friend bool operator==(const WarpSet&, const WarpSet&) = default;
};

/// Limits for files, whose contents are untrusted.
struct WarpLimits {
  std::size_t map_px = std::size_t{36} << 20;      ///< Samples of one map or mask; an 8K projector has 33 million.
  std::size_t total_bytes = std::size_t{4} << 30;  ///< All unpacked bytes of one file.
  std::size_t file_bytes = std::size_t{2} << 30;   ///< Size on the disk.
  std::size_t regions = 64;
};

/// Checks whether a set can be written or used. Errors have the form of fault(), "region 'left': ...; remedy": kBadData
/// if sizes or counts are invalid, numbers are not finite, ids are not unique, or parts that the profile needs are
/// missing.
[[nodiscard]] Status check(const WarpSet& set);
/// Checks a single region in the same way.
[[nodiscard]] Status check(const WarpRegion& region, WarpProfile profile);

}  // namespace cyclorama::interchange
