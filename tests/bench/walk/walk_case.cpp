// SPDX-License-Identifier: Apache-2.0
#include "tests/bench/walk/walk_case.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <random>
#include <span>

#include "appliance/display/eye_move.h"
#include "common/base/file.h"
#include "common/geometry/guard_band.h"
#include "common/geometry/picture_place.h"
#include "common/image/cropped.h"
#include "common/image/jpeg.h"
#include "common/image/png.h"
#include "renderfarm/balance/tiles.h"

namespace cyclorama {
namespace {

/// A surface at arm's length beside a residual of half an interval of walking; the tour's own rule.
constexpr double kResidual_m = 0.1;
constexpr double kNear_m = 1.0;
/// Makes the truth take all of its samples everywhere. Like a frame it would otherwise take one at edges of low contrast,
/// which would then move by whole pixels.
constexpr float kNoError = 1e-6f;
constexpr int kUsualJpegQuality = 85;  ///< A tour's default.
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

display::DisplayFrame frame_of(const WalkPose& pose, const PictureShape& shape, const RgbImage& pixels) {
  display::DisplayFrame frame;
  frame.eye_m = pose.eye_m;
  frame.heading_rad = pose.heading_rad;
  frame.shape = shape;
  frame.picture = std::make_shared<const PlanarPicture>(JpegEncoder().to_planar(pixels));
  return frame;
}

}  // namespace

const std::vector<WalkMethod>& walk_methods() {
  static const std::vector<WalkMethod> kAll{{"hold the last picture", false, false, false},
                                            {"predicted", true, false, false},
                                            {"moved", false, true, false},
                                            {"predicted and moved", true, true, false},
                                            {"reused", true, true, true}};
  return kAll;
}

WalkCase::WalkCase(node::BlockRenderer* renderer, WalkedPath path, const WalkPictures& pictures)
    : renderer_(*renderer),
      has_light_(renderer->light_versions() != nullptr && renderer->light_versions()->newest()),
      path_(std::move(path)),
      settings_(pictures) {
  const double tan_half = 0.5 * settings_.span_rad * settings_.height / settings_.width;
  wall_ = Panorama{settings_.width, settings_.height, settings_.span_rad, tan_half, -tan_half};
  whole_ = with_guard_band(wall_, settings_.guard_rad, parallax(kResidual_m, kNear_m));
  truth_.resize(static_cast<std::size_t>(path_.refreshes()));
  set_frames(settings_.frames);
}

void WalkCase::set_frames(const WalkFrames& frames) {
  settings_.frames = frames;
  const auto scaled = [&](int px) { return std::max(16, static_cast<int>(std::lround(frames.scale * px))); };
  picture_ = with_pixels(whole_, scaled(width_px(whole_)), scaled(height_px(whole_)));
  grid_ = std::make_shared<const display::ReprojectionGrid>(Projection{picture_, {}},
                                                            frames.fine_depth ? 1 : frames.mesh_cells * kDepthCellPx);
}

Result<std::unique_ptr<WalkCase>> WalkCase::make(node::BlockRenderer* renderer, const tour::Site& site,
                                                 double eye_height_m, WalkKind kind, const WalkPictures& pictures) {
  WalkedPath path(site, eye_height_m, kind, pictures.refresh_hz, pictures.refreshes);
  std::unique_ptr<WalkCase> walk(new WalkCase(renderer, std::move(path), pictures));
  const auto filter = pictures.without_card ? display::MeshFilter::kSharpened : display::MeshFilter::kSharp;
  TRY_ASSIGN(walk->shown_, ShownWall::make(walk->wall_, filter));
  return walk;
}

render::PanoramaView WalkCase::view_of(const WalkPose& pose, const PictureShape& shape, int samples) {
  render::PanoramaView view;
  view.eye = pose.eye_m;
  view.heading_rad = pose.heading_rad;
  view.panorama = std::get<Panorama>(shape);
  view.quality.samples = samples;
  view.quality.bounces = renderer_.bounces();
  view.quality.stored_light = has_light_;
  if (has_light_) view.light = renderer_.light_versions()->newest()->store;
  view.seed = ++seed_;
  return view;
}

render::RenderCost WalkCase::render_picture(const render::PanoramaView& view, RgbImage* ret_pixels,
                                            InverseDepthImage* ret_depth) {
  const PixelRect rect{0, 0, view.panorama.width_px, view.panorama.height_px};
  if (!view.quality.stored_light) {
    RadianceImage light;
    render::RenderCost cost = renderer_.begin_denoised(view, rect)->advance([] { return false; }, &light, ret_depth);
    *ret_pixels = renderer_.developed(light);
    return cost;
  }
  render::Film film(rect.width, rect.height, false);
  if (view.depth) {
    const PixelRect cells = depth_cells(rect);
    film.depth = InverseDepthImage(cells.width, cells.height);
  }
  render::RenderCost cost = renderer_.render_film(view, rect, {0, view.quality.samples}, &film, nullptr);
  *ret_pixels = renderer_.developed(film.mean());
  *ret_depth = std::move(film.depth);
  return cost;
}

Result<display::DisplayFrame> WalkCase::frame_at(const WalkPose& pose, bool with_mesh, WalkFigures* sums) {
  RgbImage pixels;
  InverseDepthImage depth;
  render::PanoramaView view = view_of(pose, picture_, settings_.frames.samples);
  view.depth = with_mesh;
  view.quality.stored_light = has_light_ && settings_.frames.stored_light;
  sums->cpu_s_per_frame += render_picture(view, &pixels, &depth).cpu_seconds;
  display::DisplayFrame frame = frame_of(pose, picture_, pixels);
  const int quality = settings_.frames.jpeg_quality;
  if (quality > 0 || (with_mesh && sums->frames == 0)) {
    const PixelRect whole{0, 0, pixels.width(), pixels.height()};
    auto planes = std::make_shared<PlanarPicture>(whole.width, whole.height, true);
    std::size_t jpeg_bytes = 0;
    std::size_t depth_bytes = 0;
    JpegEncoder encoder;
    JpegDecoder decoder;
    for (const PixelRect& tile : balance::tiles_of(whole)) {
      const JpegOptions options{quality > 0 ? quality : kUsualJpegQuality, true};
      TRY_ASSIGN(const auto jpeg, encoder.encode(cropped(pixels, tile), options));
      TRY(decoder.decode_into(std::as_bytes(std::span(jpeg)), planes.get(), tile));
      jpeg_bytes += jpeg.size();
      if (with_mesh) depth_bytes += encode_inverse_depth(cropped(depth, depth_cells(tile))).size();
    }
    if (sums->frames == 0) sums->depth_share = static_cast<double>(depth_bytes) / static_cast<double>(jpeg_bytes);
    if (quality > 0) frame.picture = std::move(planes);
  }
  if (with_mesh && settings_.frames.fine_depth) {
    // A cell of the larger picture is a pixel of the frame.
    RgbImage larger;
    view = view_of(pose, with_pixels(picture_, kDepthCellPx * pixels.width(), kDepthCellPx * pixels.height()), 1);
    view.depth = true;
    render_picture(view, &larger, &depth);
  }
  if (with_mesh) frame.mesh = std::make_shared<const display::ReprojectionMesh>(grid_, depth);
  return frame;
}

Result<RgbImage> WalkCase::rendered_truth(int refresh) {
  const WalkPose pose = path_.at(refresh);
  RgbImage pixels;
  InverseDepthImage none;
  render::PanoramaView view = view_of(pose, whole_, settings_.truth_samples);
  if (view.quality.stored_light) view.quality.adaptive_error = kNoError;
  render_picture(view, &pixels, &none);
  TRY(shown_->take(frame_of(pose, whole_, pixels), false));
  return shown_->shown(pose.eye_m, pose.heading_rad, false);
}

Status WalkCase::complete_truth() {
  for (int refresh = 0; refresh < path_.refreshes(); ++refresh) {
    RgbImage& truth = truth_[static_cast<std::size_t>(refresh)];
    if (!truth.empty()) continue;
    if (settings_.truth_in.empty()) {
      TRY_ASSIGN(truth, rendered_truth(refresh));
      continue;
    }
    const std::filesystem::path kept =
        settings_.truth_in / fmt::format("{}_{}x{}_{:.3f}_all{}_{:03}.rgb", to_text(path_.kind()), settings_.width,
                                         settings_.height, settings_.span_rad, settings_.truth_samples, refresh);
    RgbImage picture(settings_.width, settings_.height);
    if (const auto bytes = read_file(kept, picture.data().size()); bytes && bytes->size() == picture.data().size()) {
      std::memcpy(picture.data().data(), bytes->data(), bytes->size());
    } else {
      TRY_ASSIGN(picture, rendered_truth(refresh));
      TRY(write_file_atomically(kept, std::as_bytes(picture.data())));
    }
    truth = std::move(picture);
  }
  return Done{};
}

std::vector<WalkCase::DueFrame> WalkCase::due_frames(const WalkFarm& farm) const {
  std::mt19937 random(1);
  std::uniform_real_distribution<double> jitter_s(0.0, farm.jitter_ms / 1000.0);
  std::bernoulli_distribution is_lost(farm.lost_share);
  const double interval_s = 1.0 / farm.fps;
  const double period_s = 1.0 / settings_.refresh_hz;
  std::vector<DueFrame> due;
  for (int n = 0; n * interval_s < path_.refreshes() * period_s; ++n) {
    const double at_s = n * interval_s + farm.latency_ms / 1000.0 + jitter_s(random);
    const auto requested = static_cast<int>(std::lround(n * interval_s / period_s));
    if (is_lost(random)) continue;
    // A frame that comes after a newer one is not shown.
    while (!due.empty() && due.back().at_s >= at_s) due.pop_back();
    due.push_back({at_s, std::min(requested, path_.refreshes() - 1)});
  }
  return due;
}

Result<WalkFigures> WalkCase::measure_anew(int first) {
  WalkFigures figures;
  WalkScore score;
  TRY(complete_truth());
  for (int refresh = first; refresh < path_.refreshes(); ++refresh) {
    const WalkPose pose = path_.at(refresh);
    TRY_ASSIGN(const display::DisplayFrame frame, frame_at(pose, true, &figures));
    ++figures.frames;
    TRY(shown_->take(frame, refresh > first));
    TRY_ASSIGN(RgbImage shown, shown_->shown(pose.eye_m, pose.heading_rad, false));
    TRY(score.add(std::move(shown), truth_[static_cast<std::size_t>(refresh)], true));
  }
  if (score.refreshes() == 0) return Error(ErrorCode::kInvalidArgument, "the walk ends before it is judged");
  score.write_to(&figures);
  figures.cpu_s_per_frame /= std::max(1, figures.frames);
  return figures;
}

Result<WalkFigures> WalkCase::measure(const WalkFarm& farm, const WalkMethod& method,
                                      const std::filesystem::path& pictures_to) {
  WalkFigures figures;
  WalkScore score;
  TRY(complete_truth());
  const std::vector<DueFrame> due = due_frames(farm);
  std::size_t next = 0;
  double torn = 0.0;
  std::optional<display::DisplayFrame> frame;
  for (int refresh = 0; refresh < path_.refreshes(); ++refresh) {
    const WalkPose pose = path_.at(refresh);
    const RgbImage& truth = truth_[static_cast<std::size_t>(refresh)];
    bool is_new = false;
    while (next < due.size() && due[next].at_s <= refresh / settings_.refresh_hz + 1e-9) ++next, is_new = true;
    if (next == 0) continue;
    std::optional<RgbImage> by_old;
    if (is_new) {
      if (frame) {
        TRY_ASSIGN(by_old, shown_->shown(pose.eye_m, pose.heading_rad, method.moves));
      }
      const bool reuses = method.reuses && frame.has_value();
      const int requested = due[next - 1].requested;
      const double ahead_s = farm.latency_ms / 1000.0 + 0.5 / farm.fps;
      TRY_ASSIGN(frame, frame_at(method.predicts ? path_.predicted(requested, ahead_s) : path_.at(requested),
                                 method.moves, &figures));
      ++figures.frames;
      TRY(shown_->take(*frame, reuses));
    }
    TRY_ASSIGN(const RgbImage shown, shown_->shown(pose.eye_m, pose.heading_rad, method.moves));
    if (by_old) score.add_switch(*by_old, shown);
    if (frame->mesh != nullptr) {
      torn += torn_px(*frame, display::eye_move(frame->eye_m, frame->heading_rad, pose.eye_m).eye_m);
    }
    TRY_ASSIGN(const bool is_worst, score.add(shown, truth, is_new));
    if (is_worst && !pictures_to.empty()) {
      const std::string name =
          fmt::format("{}_{}_{}_{}", to_text(path_.kind()), farm.fps, farm.latency_ms, method.name);
      TRY(write_png(pictures_to / (name + ".png"), shown));
      TRY(write_png(pictures_to / (name + "_truth.png"), truth));
    }
  }
  if (score.refreshes() == 0)
    return Error(ErrorCode::kInvalidArgument, "the walk ends before its first frame is shown");
  score.write_to(&figures);
  figures.holes = torn / (score.refreshes() * static_cast<double>(width_px(picture_)) * height_px(picture_));
  figures.cpu_s_per_frame /= std::max(1, figures.frames);
  return figures;
}

}  // namespace cyclorama
