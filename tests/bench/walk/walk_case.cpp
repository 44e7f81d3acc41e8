// SPDX-License-Identifier: Apache-2.0
#include "tests/bench/walk/walk_case.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "appliance/display/eye_move.h"
#include "common/geometry/guard_band.h"
#include "common/geometry/picture_place.h"
#include "common/image/cropped.h"
#include "common/image/jpeg.h"
#include "common/image/png.h"
#include "renderfarm/balance/tiles.h"
#include "renderfarm/quality/shown_error.h"

namespace cyclorama {
namespace {

/// A surface at arm's length beside a residual of half an interval of walking; the tour's own rule.
constexpr double kResidual_m = 0.1;
constexpr double kNear_m = 1.0;
constexpr int kJudgedEvery = 8;

double mean_square(const RgbImage& a, const RgbImage& b) {
  double sum = 0.0;
  for (std::size_t i = 0; i < a.data().size(); ++i) {
    const double difference = static_cast<double>(a.data()[i]) - b.data()[i];
    sum += difference * difference;
  }
  return sum / static_cast<double>(a.data().size());
}

double psnr_of(double mean_square) { return 10.0 * std::log10(255.0 * 255.0 / std::max(mean_square, 1e-6)); }

/// Squares of the true change from one refresh to the next, and of what the shown change differs by.
struct Change {
  double truth = 0.0;
  double error = 0.0;
  [[nodiscard]] double share() const { return truth > 0.0 ? std::sqrt(error / truth) : 0.0; }
};

void add_change(const RgbImage& shown, const RgbImage& shown_before, const RgbImage& truth,
                const RgbImage& truth_before, Change* change) {
  for (std::size_t i = 0; i < shown.data().size(); ++i) {
    const int change_of_truth = truth.data()[i] - truth_before.data()[i];
    const int error = shown.data()[i] - shown_before.data()[i] - change_of_truth;
    change->truth += change_of_truth * change_of_truth;
    change->error += error * error;
  }
}

/// Area of the torn quads' far sides; what nearer surfaces cover is not taken off.
double torn_px(const display::DisplayFrame& frame, const Eigen::Vector3d& eye_move) {
  display::ReprojectedPicture moved;
  frame.mesh->move(eye_move, &moved);
  double area = 0.0;
  for (std::size_t i = moved.vertices.size() - 8 * moved.torn; i < moved.vertices.size(); i += 8) {
    const auto at = [&](std::size_t k) {
      return Eigen::Vector2d(moved.vertices[i + k].across_px, moved.vertices[i + k].down_px);
    };
    const Eigen::Vector2d a = at(3) - at(0);
    const Eigen::Vector2d b = at(2) - at(1);
    area += 0.5 * std::abs(a.x() * b.y() - a.y() * b.x());
  }
  return area;
}

}  // namespace

const std::vector<WalkMethod>& walk_methods() {
  static const std::vector<WalkMethod> kAll{{"hold the last picture", false, false},
                                            {"predicted", true, false},
                                            {"moved", false, true},
                                            {"predicted and moved", true, true}};
  return kAll;
}

WalkCase::WalkCase(node::BlockRenderer* renderer, WalkedPath path, const WalkPictures& pictures)
    : renderer_(*renderer), path_(std::move(path)), settings_(pictures) {
  const double tan_half = 0.5 * settings_.span_rad * settings_.height / settings_.width;
  wall_ = Panorama{settings_.width, settings_.height, settings_.span_rad, tan_half, -tan_half};
  whole_ = with_guard_band(wall_, settings_.guard_rad, parallax(kResidual_m, kNear_m));
  const auto scaled = [&](int px) { return std::max(16, static_cast<int>(std::lround(settings_.scale * px))); };
  picture_ = with_pixels(whole_, scaled(width_px(whole_)), scaled(height_px(whole_)));
  grid_ =
      std::make_shared<const display::ReprojectionGrid>(Projection{picture_, {}}, settings_.mesh_cells * kDepthCellPx);
  truth_.resize(static_cast<std::size_t>(path_.refreshes()));
}

Result<std::unique_ptr<WalkCase>> WalkCase::make(node::BlockRenderer* renderer, const tour::Site& site,
                                                 double eye_height_m, WalkKind kind, const WalkPictures& pictures) {
  WalkedPath path(site, eye_height_m, kind, pictures.refresh_hz, pictures.refreshes);
  std::unique_ptr<WalkCase> walk(new WalkCase(renderer, std::move(path), pictures));
  TRY_ASSIGN(walk->shown_, ShownWall::make(walk->wall_));
  return walk;
}

display::DisplayFrame WalkCase::rendered(const WalkPose& pose, const PictureShape& shape, int samples, bool with_mesh,
                                         RgbImage* ret_pixels, InverseDepthImage* ret_depth) {
  render::PanoramaView view;
  view.eye = pose.eye_m;
  view.heading_rad = pose.heading_rad;
  view.panorama = std::get<Panorama>(shape);
  view.quality.samples = samples;
  view.quality.bounces = renderer_.bounces();
  view.quality.stored_light = true;
  view.depth = with_mesh;
  view.seed = ++seed_;
  renderer_.render(view, {0, 0, width_px(shape), height_px(shape)}, ret_pixels, ret_depth, nullptr);
  display::DisplayFrame frame;
  frame.eye_m = pose.eye_m;
  frame.heading_rad = pose.heading_rad;
  frame.shape = shape;
  frame.picture = std::make_shared<const PlanarPicture>(JpegEncoder().to_planar(*ret_pixels));
  return frame;
}

Result<display::DisplayFrame> WalkCase::frame_at(const WalkPose& pose, bool with_mesh, WalkFigures* bytes) {
  RgbImage pixels;
  InverseDepthImage depth;
  display::DisplayFrame frame = rendered(pose, picture_, settings_.samples, with_mesh, &pixels, &depth);
  if (settings_.jpeg_quality > 0) {
    const PixelRect whole{0, 0, pixels.width(), pixels.height()};
    auto planes = std::make_shared<PlanarPicture>(whole.width, whole.height, true);
    std::size_t jpeg_bytes = 0;
    std::size_t depth_bytes = 0;
    JpegEncoder encoder;
    JpegDecoder decoder;
    for (const PixelRect& tile : balance::tiles_of(whole)) {
      TRY_ASSIGN(const auto jpeg, encoder.encode(cropped(pixels, tile), {settings_.jpeg_quality, true}));
      TRY(decoder.decode_into(std::as_bytes(std::span(jpeg)), planes.get(), tile));
      jpeg_bytes += jpeg.size();
      if (with_mesh) depth_bytes += encode_inverse_depth(cropped(depth, depth_cells(tile))).size();
    }
    bytes->depth_share += static_cast<double>(depth_bytes) / static_cast<double>(jpeg_bytes);
    frame.picture = std::move(planes);
  }
  if (with_mesh) frame.mesh = std::make_shared<const display::ReprojectionMesh>(grid_, depth);
  return frame;
}

Result<const RgbImage*> WalkCase::truth_at(int refresh) {
  RgbImage& truth = truth_[static_cast<std::size_t>(refresh)];
  if (truth.empty()) {
    const WalkPose pose = path_.at(refresh);
    RgbImage pixels;
    InverseDepthImage none;
    TRY(shown_->take(rendered(pose, whole_, settings_.truth_samples, false, &pixels, &none)));
    TRY_ASSIGN(truth, shown_->shown(pose.eye_m, pose.heading_rad, false));
  }
  return &truth;
}

Result<WalkFigures> WalkCase::measure(const WalkFarm& farm, const WalkMethod& method,
                                      const std::filesystem::path& pictures_to) {
  WalkFigures figures;
  std::mt19937 random(1);
  std::uniform_real_distribution<double> jitter(0.0, farm.jitter_ms / 1000.0);
  const double latency_s = farm.latency_ms / 1000.0;
  const double interval_s = 1.0 / farm.fps;
  const double period_s = 1.0 / settings_.refresh_hz;
  std::vector<std::pair<double, int>> due;  // Time at which a frame is shown, and the refresh of its request.
  for (int n = 0; n * interval_s < path_.refreshes() * period_s; ++n) {
    due.emplace_back(n * interval_s + latency_s + jitter(random),
                     static_cast<int>(std::lround(n * interval_s / period_s)));
  }
  std::size_t next = 0;
  int judged = 0;
  int counted = 0;
  double square = 0.0;
  double torn = 0.0;
  Change at_switch;
  Change between;
  RgbImage before;
  std::optional<display::DisplayFrame> frame;
  for (int refresh = 0; refresh < path_.refreshes(); ++refresh) {
    TRY_ASSIGN(const RgbImage* const truth, truth_at(refresh));
    bool is_new = false;
    while (next < due.size() && due[next].first <= refresh * period_s + 1e-9) ++next, is_new = true;
    if (next == 0) continue;
    if (is_new) {
      const int asked = std::min(due[next - 1].second, path_.refreshes() - 1);
      const WalkPose pose = method.predicts ? path_.predicted(asked, latency_s + 0.5 * interval_s) : path_.at(asked);
      TRY_ASSIGN(frame, frame_at(pose, method.moves, &figures));
      ++figures.frames;
    }
    TRY(shown_->take(*frame));
    const WalkPose pose = path_.at(refresh);
    TRY_ASSIGN(RgbImage shown, shown_->shown(pose.eye_m, pose.heading_rad, method.moves));
    const double error = mean_square(shown, *truth);
    square += error;
    ++counted;
    if (frame->mesh != nullptr) {
      torn += torn_px(*frame, display::eye_move(frame->eye_m, frame->heading_rad, pose.eye_m).eye_m);
    }
    if (!before.empty()) {
      add_change(shown, before, *truth, truth_[static_cast<std::size_t>(refresh - 1)], is_new ? &at_switch : &between);
    }
    if (psnr_of(error) < figures.worst_psnr_db) {
      figures.worst_psnr_db = psnr_of(error);
      if (!pictures_to.empty()) {
        const std::string name =
            fmt::format("{}_{}_{}_{}", to_text(path_.kind()), farm.fps, farm.latency_ms, method.name);
        TRY(write_png(pictures_to / (name + ".png"), shown));
        TRY(write_png(pictures_to / (name + "_truth.png"), *truth));
      }
    }
    if (counted % kJudgedEvery == 0) {
      TRY_ASSIGN(const quality::ShownError judged_error, quality::shown_error(shown, *truth));
      figures.ssim += judged_error.ssim;
      figures.flip += judged_error.flip;
      ++judged;
    }
    before = std::move(shown);
  }
  if (counted == 0) return Error(ErrorCode::kInvalidArgument, "the walk ends before its first frame is shown");
  figures.psnr_db = psnr_of(square / counted);
  figures.ssim /= std::max(1, judged);
  figures.flip /= std::max(1, judged);
  figures.switch_share = at_switch.share();
  figures.step_share = between.share();
  figures.holes = torn / (counted * static_cast<double>(width_px(picture_)) * height_px(picture_));
  figures.depth_share /= std::max(1, figures.frames);
  return figures;
}

}  // namespace cyclorama
