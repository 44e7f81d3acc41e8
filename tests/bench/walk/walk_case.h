// SPDX-License-Identifier: Apache-2.0
/// A walk, shown by a display whose farm sends a picture only now and then, against the truth at every refresh.
#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <vector>

#include "renderfarm/node/block_renderer.h"
#include "tests/bench/walk/shown_wall.h"
#include "tests/bench/walk/walk_score.h"
#include "tests/bench/walk/walked_path.h"

namespace cyclorama {

/// The display's work between two frames.
struct WalkMethod {
  const char* name;
  bool predicts;  ///< Views are requested for the position where the visitor will be.
  bool moves;     ///< The display moves the frame's eye.
  bool reuses;    ///< The display reuses what earlier frames showed.
};
[[nodiscard]] const std::vector<WalkMethod>& walk_methods();

struct WalkFarm {
  int fps = 10;
  int latency_ms = 200;
  double jitter_ms = 0.0;   ///< Frames are late by up to this much, at random.
  double lost_share = 0.0;  ///< Share of the frames that never come, at random.
};

/// Frames as the farm sends them.
struct WalkFrames {
  double scale = 1.0;  ///< Their size over the wall's, each way; the truth has the wall's.
  int samples = 4;
  bool stored_light = true;  ///< False: path traced and denoised; the truth reads stored light all the same, if it can.
  int jpeg_quality = 0;      ///< 0: frames reach the display without JPEG.
  int mesh_cells = 1;        ///< A display without a card has 2.
  /// The display gets the depth of each pixel, and a mesh as fine: more than a frame can carry.
  bool fine_depth = false;
};

struct WalkPictures {
  int width = 1024;
  int height = 384;
  double span_rad = 2.6179938779914944;   ///< 150 degrees.
  double guard_rad = 0.1396263401595464;  ///< 8 degrees: the tour's default.
  int truth_samples = 16;
  double refresh_hz = 60.0;
  int refreshes = 90;
  WalkFrames frames;
  bool without_card = false;  ///< Filters as a display on a software renderer.
  /// Folder of one scene's truth, which is written there and read again; empty: none.
  std::filesystem::path truth_in;
};

/// Renders and shows one walk. Keeps the truth, so that several farms and methods are compared with the same.
class WalkCase {
 public:
  /// Borrows the renderer. Errors: ShownWall's.
  static Result<std::unique_ptr<WalkCase>> make(node::BlockRenderer* renderer, const tour::Site& site,
                                                double eye_height_m, WalkKind kind, const WalkPictures& pictures);

  /// `pictures_to`: folder for the worst refresh, beside the truth; empty: none. Errors: GL's; writing pictures.
  Result<WalkFigures> measure(const WalkFarm& farm, const WalkMethod& method, const std::filesystem::path& pictures_to);
  /// Measures a farm without delay that renders a frame for each refresh, from `first` on: how well frames of this
  /// quality show motion at all, whatever a display does between them. Errors: those of measure().
  Result<WalkFigures> measure_anew(int first);
  /// Frames of later measurements; the truth stays.
  void set_frames(const WalkFrames& frames);
  [[nodiscard]] const WalkedPath& path() const { return path_; }

 private:
  struct DueFrame {
    double at_s = 0.0;  ///< Time at which it can be shown.
    int requested = 0;  ///< Refresh of its request.
  };
  WalkCase(node::BlockRenderer* renderer, WalkedPath path, const WalkPictures& pictures);
  /// A frame as the farm sends it; its bytes and its cost are added to `sums`.
  Result<display::DisplayFrame> frame_at(const WalkPose& pose, bool with_mesh, WalkFigures* sums);
  [[nodiscard]] render::PanoramaView view_of(const WalkPose& pose, const PictureShape& shape, int samples);
  /// Renders what is missing of the truth at all refreshes.
  Status complete_truth();
  Result<RgbImage> rendered_truth(int refresh);
  /// Renders a whole picture as a node does: denoised unless it reads stored light.
  render::RenderCost render_picture(const render::PanoramaView& view, RgbImage* ret_pixels,
                                    InverseDepthImage* ret_depth);
  /// The frames that come, in the order of their requests.
  [[nodiscard]] std::vector<DueFrame> due_frames(const WalkFarm& farm) const;

  node::BlockRenderer& renderer_;
  bool has_light_ =
      false;  ///< Light was stored for the scene. Otherwise frames and truth are path traced and denoised.
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
