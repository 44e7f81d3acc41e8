// SPDX-License-Identifier: Apache-2.0
/// Decodes and calibrates the real captures, and measures both. Usage: calibration_real FOLDER [--quick]
#include <fmt/format.h>

#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <string>
#include <vector>

#include "appliance/camera_calibration/chessboard.h"
#include "appliance/camera_calibration/procam_selection.h"
#include "appliance/camera_calibration/projector_corners.h"
#include "appliance/structured_light/decode_quality.h"
#include "tests/bench/calibration/procam_truth.h"
#include "tests/data_sets/lit_wall.h"
#include "tests/data_sets/real_captures.h"

namespace cyclorama {
namespace {

constexpr int kColumns = 9;
constexpr int kRows = 7;
constexpr double kSquareM = 0.075;
/// Fraction of the light between white and black; below it is the board's shadow, which receives only indirect light.
constexpr double kLit = 20.0 / 255.0;
constexpr double kCornerRadiusPx = 24.0;

struct Capture {
  structured_light::Decoder decoder;
  GreyImage white;
};

Result<std::vector<Capture>> load(const std::filesystem::path& folder) {
  std::vector<Capture> captures;
  for (int c = 0; c < kRealCaptures; ++c) {
    TRY_ASSIGN(structured_light::Decoder decoder, real_decoder(folder, c));
    TRY_ASSIGN(GreyImage white, real_photo(folder, c, kRealWhite));
    captures.push_back({std::move(decoder), std::move(white)});
  }
  return captures;
}

Result<camera_calibration::BoardView> view_of(const Capture& capture, const structured_light::Decoded& decoded) {
  TRY_ASSIGN(const auto corners, camera_calibration::find_chessboard(capture.white, kColumns, kRows));
  const auto board = camera_calibration::chessboard_corners(kColumns, kRows, kSquareM);
  camera_calibration::BoardView view;
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const auto position = projector_pixel_at(decoded, corners[i], kCornerRadiusPx);
    if (!position) continue;
    view.board_m.push_back(board[i]);
    view.camera_px.push_back(corners[i]);
    view.projector_px.push_back(*position);
  }
  return view;
}

/// Quality of a view's decoding, by itself and compared with the calibration.
struct Figures {
  double coverage = 0.0;
  double gross = 0.0;
  double gross_by_planes = 0.0;
  double residual_median_px = 0.0;
  double residual_p99_px = 0.0;
  double truth_median_px = 0.0;
};

Figures figures_of(const std::vector<structured_light::Decoded>& decoded,
                   const std::vector<camera_calibration::BoardView>& views,
                   const camera_calibration::ProcamCalibration& calibration, int every) {
  Figures mean;
  TruthScore score;
  for (std::size_t i = 0; i < decoded.size(); ++i) {
    const structured_light::DecodeQuality quality = structured_light::quality_of(decoded[i], kLit);
    const auto share = 1.0 / static_cast<double>(decoded.size());
    mean.coverage += share * quality.coverage;
    mean.gross_by_planes += share * quality.gross;
    mean.residual_median_px += share * quality.residual_median_px;
    mean.residual_p99_px += share * quality.residual_p99_px;
    score_against(decoded[i], views[i], calibration, i, every, &score);
  }
  mean.gross = score.gross();
  mean.truth_median_px = score.board_median_px();
  return mean;
}

Result<std::vector<structured_light::Decoded>> decode(const std::vector<Capture>& captures,
                                                      const structured_light::DecodeSettings& settings) {
  std::vector<structured_light::Decoded> all;
  for (const Capture& capture : captures) {
    TRY_ASSIGN(structured_light::Decoded decoded, capture.decoder.finish(settings));
    all.push_back(std::move(decoded));
  }
  return all;
}

/// Rounds positions to whole pixels: the result of the same readings without edges.
structured_light::Decoded whole_pixels(structured_light::Decoded decoded) {
  for (std::size_t i = 0; i < decoded.fate.data().size(); ++i) {
    if (decoded.fate.data()[i] != structured_light::PixelFate::kDecoded) continue;
    for (std::size_t a = 0; a < 2; ++a) {
      float& position = decoded.position_px.data()[2 * i + a];
      position = std::floor(position) + 0.5f;
    }
  }
  return decoded;
}

void print_curve_row(const std::string& name, const Figures& f) {
  fmt::print("| {:<24} | {:6.2f} | {:7.4f} | {:7.4f} | {:6.3f} | {:6.3f} | {:6.3f} |\n", name, 100.0 * f.coverage,
             100.0 * f.gross, 100.0 * f.gross_by_planes, f.residual_median_px, f.residual_p99_px, f.truth_median_px);
}

Status print_curves(const std::vector<Capture>& captures, const std::vector<camera_calibration::BoardView>& views,
                    const camera_calibration::ProcamCalibration& calibration, bool is_quick) {
  fmt::print("\nEach setting by itself, the others as they are by default; means of the captures\n");
  fmt::print(
      "| setting                  | lit, % | gross,% | planes% | median | p99 px | board  "
      "|\n|---|---|---|---|---|---|---|\n");
  const auto row = [&](const std::string& name, const structured_light::DecodeSettings& settings) -> Status {
    TRY_ASSIGN(const auto decoded, decode(captures, settings));
    print_curve_row(name, figures_of(decoded, views, calibration, 3));
    return Done{};
  };
  TRY(row("default", structured_light::DecodeSettings{}));
  if (is_quick) return Done{};
  for (const double sigmas : {0.0, 1.0, 2.0, 4.0, 8.0}) {
    structured_light::DecodeSettings settings;
    settings.undecided.sigmas = sigmas;
    TRY(row(fmt::format("undecided sigmas {:g}", sigmas), settings));
  }
  for (const double contrast : {0.0, 0.02, 0.05, 0.1, 0.15, 0.2}) {
    structured_light::DecodeSettings settings;
    settings.undecided.contrast = contrast;
    TRY(row(fmt::format("undecided contrast {:g}", contrast), settings));
  }
  for (const int patch : {1, 10, 60, 300, 1000}) {
    structured_light::DecodeSettings settings;
    settings.min_patch_px = patch;
    TRY(row(fmt::format("smallest patch {}", patch), settings));
  }
  for (const double darkest : {0.0, 0.02, 0.04, 0.06, 0.08}) {
    structured_light::DecodeSettings settings;
    settings.darkest = darkest;
    TRY(row(fmt::format("darkest {:g}", darkest), settings));
  }
  for (const double share : {0.0, 0.2, 0.4, 0.5, 0.6, 0.7, 0.8}) {
    structured_light::DecodeSettings settings;
    settings.min_direct_share = share;
    TRY(row(fmt::format("least direct share {:g}", share), settings));
  }
  for (const double sigma : {0.05, 0.1, 0.2, 0.3, 0.6, 1.2, 2.4}) {
    structured_light::DecodeSettings settings;
    settings.max_sigma_px = sigma;
    TRY(row(fmt::format("largest sigma {:g} px", sigma), settings));
  }
  for (const double disturbance : {0.03, 0.06, 0.12, 1.0}) {
    structured_light::DecodeSettings settings;
    settings.disturbance = disturbance;
    TRY(row(fmt::format("disturbance {:g}", disturbance), settings));
  }
  structured_light::DecodeSettings bare;
  bare.undecided = {};
  bare.min_patch_px = 1;
  bare.darkest = 0.0;
  bare.min_direct_share = 0.0;
  bare.disturbance = 10.0;
  bare.max_sigma_px = 100.0;
  return row("no threshold at all", bare);
}

void print_lens(const char* name, const calibration::BrownParameters& lens, const calibration::BrownBlock& sigma) {
  fmt::print(
      "{}: f {:.1f} ± {:.1f}, centre ({:.1f} ± {:.1f}, {:.1f} ± {:.1f}), k1 {:.4f} ± {:.4f}, k2 {:.3f}, p ({:.5f}, "
      "{:.5f}), k3 {:.2f}\n",
      name, lens.focal_u_px, sigma[calibration::kFocalU], lens.centre_u_px, sigma[calibration::kCentreU],
      lens.centre_v_px, sigma[calibration::kCentreV], lens.k1, sigma[calibration::kK1], lens.k2, lens.p1, lens.p2,
      lens.k3);
}

void print_selection(const camera_calibration::ProcamSelection& selection) {
  fmt::print(
      "\n| camera | projector | board | free | training px | left out px | predicted px | centre scatter px "
      "|\n|---|---|---|---|---|---|---|---|\n");
  for (std::size_t i = 0; i < selection.models.size(); ++i) {
    const camera_calibration::ProcamCandidate& model = selection.models[i];
    fmt::print("| {} | {} | {} | {} | {:.3f} | {:.3f} | {:.3f} | {:.1f} |{}\n", name_of(model.camera),
               name_of(model.projector), model.board == camera_calibration::BoardModel::kFlat ? "flat" : "bent",
               model.freedom, model.training_rms_px, model.heldout_rms_px, model.prediction_rms_px,
               model.centre_scatter_px, i == selection.chosen ? " <- chosen" : "");
  }
  const camera_calibration::ProcamCandidate& chosen = selection.models[selection.chosen];
  fmt::print("\n| left out | camera px | projector, predicted px | stereo px |\n|---|---|---|---|\n");
  for (std::size_t i = 0; i < chosen.folds.size(); ++i) {
    const camera_calibration::HeldOut& fold = chosen.folds[i];
    fmt::print("| capture {} | {:.3f} | {:.3f} | {:.3f} |\n", i, fold.camera_rms_px, fold.projector_rms_px,
               fold.stereo_rms_px);
  }
}

/// Cameras of 0.3 to 20 megapixels in front of the same projector. The wall is computed, since there are no such
/// photographs.
Status print_sizes() {
  fmt::print(
      "\nSimulated cameras before a projector of 1024x768\n| camera | projector px a camera px | decoded, % | gross, % "
      "| median px | decoding, s |\n|---|---|---|---|---|---|\n");
  TRY_ASSIGN(const structured_light::PatternSet set,
             structured_light::structured_light({.width_px = 1024, .height_px = 768}));
  for (const int width : {240, 640, 1280, 2592, 5184}) {
    LitWall wall;
    wall.camera_width_px = width;
    wall.camera_height_px = width * 3 / 4;
    const double scale = 1000.0 / width;
    wall.projector_pixel_at = [scale](double u, double v) {
      return Eigen::Vector2d(12.0 + scale * u, 9.0 + scale * v);
    };
    wall.blur_px = std::max(0.7, 0.5 * scale);
    const structured_light::Decoder decoder = wall.decoder(set);
    const auto before = std::chrono::steady_clock::now();
    TRY_ASSIGN(const structured_light::Decoded decoded, decoder.finish());
    const std::chrono::duration<double> seconds = std::chrono::steady_clock::now() - before;
    const WallErrors errors = errors_of(wall, decoded);
    const auto pixels = static_cast<double>(decoded.fate.data().size());
    fmt::print("| {}x{} | {:.2f} | {:.2f} | {:.4f} | {:.3f} | {:.2f} |\n", width, width * 3 / 4, scale,
               100.0 * errors.decoded / pixels, 100.0 * errors.gross / std::max(1, errors.decoded), errors.median_px,
               seconds.count());
  }
  return Done{};
}

Status run(const std::filesystem::path& folder, bool is_quick) {
  TRY_ASSIGN(const auto captures, load(folder));
  const auto before = std::chrono::steady_clock::now();
  TRY_ASSIGN(const auto decoded, decode(captures, structured_light::DecodeSettings{}));
  const std::chrono::duration<double> seconds = std::chrono::steady_clock::now() - before;
  std::vector<camera_calibration::BoardView> views;
  fmt::print("| capture | noise, % | of pixels: lit, % |");
  for (std::size_t f = 0; f < structured_light::kPixelFates; ++f)
    fmt::print(" {}, % |", name_of(static_cast<structured_light::PixelFate>(f)));
  fmt::print(" of lit: decoded, % | median px | whole pixels |\n|---|---|---|---|---|---|---|---|---|---|---|---|\n");
  for (std::size_t i = 0; i < captures.size(); ++i) {
    const structured_light::DecodeQuality quality = structured_light::quality_of(decoded[i], kLit);
    const auto pixels = static_cast<double>(decoded[i].fate.data().size());
    fmt::print("| {} | {:.2f} | {:.1f} |", i, 100.0 * decoded[i].noise, 100.0 * quality.lit / pixels);
    for (const int count : quality.fates) fmt::print(" {:.2f} |", 100.0 * count / pixels);
    fmt::print(" {:.2f} | {:.3f} | {:.3f} |\n", 100.0 * quality.coverage, quality.residual_median_px,
               structured_light::quality_of(whole_pixels(decoded[i]), kLit).residual_median_px);
    TRY_ASSIGN(camera_calibration::BoardView view, view_of(captures[i], decoded[i]));
    fmt::print("  capture {}: {} corners on the projector\n", i, view.board_m.size());
    views.push_back(std::move(view));
  }
  fmt::print("decoding takes {:.2f} s a capture of 1.3 megapixels\n",
             seconds.count() / static_cast<double>(captures.size()));
  TRY_ASSIGN(const camera_calibration::ProcamSelection selection,
             camera_calibration::select_procam_model(views, {1280, 1024}, {1024, 768}));
  print_selection(selection);
  const camera_calibration::ProcamCalibration& calibration = selection.calibration;
  print_lens("camera", calibration.camera, calibration.camera_sigma);
  print_lens("projector", calibration.projector, calibration.projector_sigma);
  const camera_calibration::BoardShape& board = calibration.board;
  fmt::print("board: stretched by {:.3f} %, bent by {:.4f}, {:.4f}, {:.4f} per metre\n", 100.0 * board.stretch,
             board.bend_xx, board.bend_xy, board.bend_yy);
  fmt::print("camera {:.3f}, projector {:.3f}, stereo {:.3f} px; rank {} of {}; {} of {} starting points agree\n",
             calibration.camera_rms_px, calibration.projector_rms_px, calibration.stereo_rms_px, calibration.rank,
             calibration.unknowns, calibration.starts_agreeing, camera_calibration::kMaxStarts);
  TRY(print_curves(captures, views, calibration, is_quick));
  if (!is_quick) TRY(print_sizes());
  const Figures figures = figures_of(decoded, views, calibration, 1);
  const camera_calibration::ProcamCandidate& chosen = selection.models[selection.chosen];
  std::string folds;
  for (const camera_calibration::HeldOut& fold : chosen.folds)
    folds += fmt::format("{}{:.4f}", folds.empty() ? "" : ", ", fold.stereo_rms_px);
  fmt::print(
      "{{\"benchmark\": \"calibration-real\", \"coverage\": {:.4f}, \"gross\": {:.6f}, \"residual_median_px\": {:.4f}, "
      "\"stereo_rms_px\": {:.4f}, "
      "\"heldout_rms_px\": {:.4f}, \"heldout_by_capture_px\": [{}], \"predicted_rms_px\": {:.4f}, \"camera_model\": "
      "\"{}\", \"projector_model\": \"{}\", \"board_model\": \"{}\", "
      "\"decode_s\": {:.3f}}}\n",
      figures.coverage, figures.gross, figures.residual_median_px, calibration.stereo_rms_px, chosen.heldout_rms_px,
      folds, chosen.prediction_rms_px, name_of(chosen.camera), name_of(chosen.projector),
      chosen.board == camera_calibration::BoardModel::kFlat ? "flat" : "bent",
      seconds.count() / static_cast<double>(captures.size()));
  return Done{};
}

}  // namespace
}  // namespace cyclorama

int main(int argc, char** argv) {
  if (argc < 2) return 2;
  // Line-buffered, so that each row of a curve, which takes minutes, appears at once.
  std::setvbuf(stdout, nullptr, _IOLBF, 1 << 16);
  const auto status = cyclorama::run(argv[1], argc > 2 && std::strcmp(argv[2], "--quick") == 0);
  if (!status) fmt::print(stderr, "calibration_real: {}\n", status.error().message());
  return status ? 0 : 1;
}
