// SPDX-License-Identifier: Apache-2.0
/// A walk, shown by a display whose farm sends a picture only now and then, against the truth at every refresh.
#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <vector>

#include "renderfarm/node/block_renderer.h"
#include "tests/bench/walk/shown_wall.h"
#include "tests/bench/walk/walked_path.h"

namespace cyclorama {

/// The display's work between two frames.
struct WalkMethod {
  const char* name;
  bool predicts;  ///< Views are asked for where the visitor will be.
  bool moves;     ///< The display moves the frame's eye.
};
[[nodiscard]] const std::vector<WalkMethod>& walk_methods();

struct WalkFarm {
  int fps = 10;
  int latency_ms = 200;
  double jitter_ms = 0.0;  ///< Frames are late by up to this much, at random.
};

/// Pictures as a museum gets them: quality, size, and the guard band that the tour adds.
struct WalkPictures {
  int width = 1024;
  int height = 384;
  double span_rad = 2.6179938779914944;   ///< 150 degrees.
  double guard_rad = 0.1396263401595464;  ///< 8 degrees: the tour's default.
  double scale = 1.0;  ///< Size of the farm's frames over the wall's, each way; the truth has the wall's.
  int samples = 4;
  int truth_samples = 16;
  int jpeg_quality = 0;  ///< 0: frames reach the display without JPEG.
  int mesh_cells = 1;
  double refresh_hz = 60.0;
  int refreshes = 90;
};

/// Means over the refreshes from the first frame on.
struct WalkFigures {
  double psnr_db = 0.0;  ///< From the mean squared error over all refreshes.
  double ssim = 0.0;     ///< Measured at every eighth refresh, like flip.
  double flip = 0.0;
  double worst_psnr_db = 1e9;
  double switch_share = 0.0;  ///< At a new frame: error of the change between two refreshes over the true change; RMS.
  double step_share = 0.0;    ///< The same at all other refreshes.
  double holes = 0.0;         ///< Upper bound: area of torn quads in the pictures, over their area.
  double depth_share = 0.0;   ///< Bytes of depth over those of JPEG; 0 without JPEG.
  int frames = 0;
};

/// Renders and shows one walk. Keeps the truth, so that several farms and methods are compared with the same.
class WalkCase {
 public:
  /// Borrows the renderer. Errors: ShownWall's.
  static Result<std::unique_ptr<WalkCase>> make(node::BlockRenderer* renderer, const tour::Site& site,
                                                double eye_height_m, WalkKind kind, const WalkPictures& pictures);

  /// `pictures_to`: folder for the worst refresh, beside the truth; empty: none. Errors: GL's; writing pictures.
  Result<WalkFigures> measure(const WalkFarm& farm, const WalkMethod& method, const std::filesystem::path& pictures_to);
  [[nodiscard]] const WalkedPath& path() const { return path_; }

 private:
  WalkCase(node::BlockRenderer* renderer, WalkedPath path, const WalkPictures& pictures);
  /// A frame as the farm sends it; the bytes of its parts are added to `bytes`.
  Result<display::DisplayFrame> frame_at(const WalkPose& pose, bool with_mesh, WalkFigures* bytes);
  [[nodiscard]] display::DisplayFrame rendered(const WalkPose& pose, const PictureShape& shape, int samples,
                                               bool with_mesh, RgbImage* ret_pixels, InverseDepthImage* ret_depth);
  Result<const RgbImage*> truth_at(int refresh);

  node::BlockRenderer& renderer_;
  WalkedPath path_;
  WalkPictures settings_;
  PictureShape wall_;
  PictureShape whole_;    ///< The wall's, with the guard band.
  PictureShape picture_;  ///< The farm's: smaller by `scale`.
  std::shared_ptr<const display::ReprojectionGrid> grid_;
  std::unique_ptr<ShownWall> shown_;
  std::vector<RgbImage> truth_;
  std::uint64_t seed_ = 0;
};

}  // namespace cyclorama
