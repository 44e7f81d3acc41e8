// SPDX-License-Identifier: Apache-2.0
/// cyclorama-calibrate-camera: measures a camera's lens from pictures of a printed board.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <ctime>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "appliance/calibration/camera_file.h"
#include "appliance/camera_calibration/board_search.h"
#include "appliance/camera_calibration/lens_selection.h"
#include "common/base/file.h"
#include "common/image/image_file.h"
#include "common/process/program.h"
#include "common/process/progress.h"
#include "drivers/devices/camera_spec.h"
#include "drivers/devices/make_camera.h"

namespace cyclorama::camera_calibration {
namespace {

struct Options {
  std::string pictures;
  std::string camera;
  bool is_chessboard = false;
  TagBoard board{};
  double square_mm = 24.0;
  std::string out = "camera.json";
  int views = 20;
  double timeout_s = 300.0;
};

struct Views {
  std::string camera;
  int width_px = 0;
  int height_px = 0;
  std::vector<LensView> views;
};

void add_options(CLI::App& app, Options* options) {
  auto& pictures =
      *app.add_option("--pictures", options->pictures, "A folder of PNG and JPEG files that show the board");
  app.add_option("--camera", options->camera, "Or a camera, as the tracker's --camera: show it the board")
      ->excludes(&pictures);
  app.add_option("--square-mm", options->square_mm, "Edge of a square, measured on the print")
      ->check(CLI::Range(1.0, 1000.0))
      ->capture_default_str();
  app.add_option("--columns", options->board.columns, "Squares in a row")
      ->check(CLI::Range(3, 100))
      ->capture_default_str();
  app.add_option("--rows", options->board.rows, "Squares in a column")
      ->check(CLI::Range(3, 100))
      ->capture_default_str();
  app.add_flag("--chessboard", options->is_chessboard,
               "The board has no tags; then all of it must be in every picture");
  app.add_option("--views", options->views, "With a camera: how many different views to take")
      ->check(CLI::Range(static_cast<int>(kMinViews), 200))
      ->capture_default_str();
  app.add_option("--timeout", options->timeout_s, "With a camera: seconds to wait for them")->capture_default_str();
  app.add_option("--out", options->out, "The file to write")->capture_default_str();
}

Result<BoardKind> board_of(const Options& options) {
  BoardKind kind{options.board, options.is_chessboard};
  kind.tags.tag_m = kind.tags.tag_m / kind.tags.square_m * 1e-3 * options.square_mm;
  kind.tags.square_m = 1e-3 * options.square_mm;
  const int room = 587 - kind.tags.tags();
  if (room < 0) return Error(ErrorCode::kInvalidArgument, "there are 587 tags; take fewer --columns or --rows");
  kind.tags.first_tag = room;
  return kind;
}

Result<Views> from_folder(const Options& options, const BoardKind& kind, const StopSignal& stop) {
  namespace fs = std::filesystem;
  std::vector<fs::path> files;
  std::error_code problem;
  for (const auto& entry : fs::directory_iterator(options.pictures, problem)) {
    if (entry.is_regular_file(problem)) files.push_back(entry.path());
  }
  if (files.empty()) {
    return Error(ErrorCode::kNotFound,
                 fmt::format("{}: no pictures there; give a folder of PNG or JPEG files", options.pictures));
  }
  std::sort(files.begin(), files.end());
  TRY_ASSIGN(tags::TagDetector detector, make_board_detector());
  Views found{options.pictures, 0, 0, {}};
  Progress progress("looking for the board");
  for (std::size_t i = 0; i < files.size() && !stop.requested(); ++i) {
    progress.update(static_cast<double>(i) / static_cast<double>(files.size()));
    const std::string name = files[i].filename().string();
    const auto picture = read_grey_image(files[i], kPhotoLimitPx);
    if (!picture) {
      std::fprintf(stderr, "%s, ignoring\n", picture.error().message().c_str());
      continue;
    }
    if (found.width_px == 0) {
      found.width_px = picture->width();
      found.height_px = picture->height();
    }
    if (picture->width() != found.width_px || picture->height() != found.height_px) {
      return Error(ErrorCode::kInvalidArgument,
                   fmt::format("{} has another size than the pictures before; one camera, one size", name));
    }
    auto view = find_board(*picture, kind, &detector);
    if (!view) {
      std::fprintf(stderr, "%s: %s, ignoring\n", name.c_str(), view.error().message().c_str());
      continue;
    }
    view->name = name;
    found.views.push_back(*std::move(view));
  }
  return found;
}

/// Collects views of the board at rest that differ from all previous views.
Result<Views> from_camera(const Options& options, const BoardKind& kind, const StopSignal& stop) {
  constexpr double kStill_px = 1.0;
  const SteadyClock clock;
  TRY_ASSIGN(const std::unique_ptr<camera::Camera> camera,
             devices::make_camera(devices::with_defaults(options.camera, devices::kCalibrationSize), clock));
  TRY_ASSIGN(tags::TagDetector detector, make_board_detector());
  TRY(camera->start());
  Views found{camera->id(), 0, 0, {}};
  std::optional<LensView> last;
  std::puts("Show the camera the board: near and far, in all corners of the picture, turned by 20 to 45 degrees.");
  Progress progress("taking views");
  const TimePoint end =
      clock.now() + std::chrono::duration_cast<Duration>(std::chrono::duration<double>(options.timeout_s));
  while (!stop.requested() && clock.now() < end && static_cast<int>(found.views.size()) < options.views) {
    const auto frame = camera->next_frame(clock.now() + std::chrono::seconds(2));
    if (!frame) {
      if (frame.error().code() == ErrorCode::kTimedOut) continue;
      return frame.error();
    }
    const GreyImage& picture = (*frame)->pixels;
    found.width_px = picture.width();
    found.height_px = picture.height();
    auto view = find_board(picture, kind, &detector);
    if (!view) {
      last.reset();
      continue;
    }
    view->name = fmt::format("view {}", found.views.size() + 1);
    double moved = 1e9;
    if (last && last->board_m == view->board_m) {
      moved = 0.0;
      for (std::size_t i = 0; i < view->camera_px.size(); ++i) {
        moved += (view->camera_px[i] - last->camera_px[i]).norm() / static_cast<double>(view->camera_px.size());
      }
    }
    if (moved < kStill_px && is_new_view(*view, found.views, found.width_px, found.height_px))
      found.views.push_back(*view);
    last = *std::move(view);
    progress.update(static_cast<double>(found.views.size()) / options.views);
  }
  camera->stop();
  return found;
}

std::string now_utc() {
  const std::time_t now = std::time(nullptr);
  std::tm parts{};
  gmtime_r(&now, &parts);
  char text[40];
  static_cast<void>(std::strftime(text, sizeof text, "%Y-%m-%dT%H-%M-%SZ", &parts));
  return text;
}

Status run(const Options& options, const StopSignal& stop) {
  if (options.pictures.empty() == options.camera.empty()) {
    return Error(ErrorCode::kInvalidArgument, "give --pictures FOLDER or --camera CAMERA");
  }
  TRY_ASSIGN(const BoardKind kind, board_of(options));
  TRY_ASSIGN(const Views found,
             options.camera.empty() ? from_folder(options, kind, stop) : from_camera(options, kind, stop));
  TRY_ASSIGN(const LensSelection choice, select_lens(found.views, found.width_px, found.height_px));
  std::printf("%-16s %14s %14s\n", "lens", "left-out px", "training px");
  for (const LensTrial& trial : choice.trials) {
    std::printf("%-16s %14.3f %14.3f%s\n", std::string(calibration::name_of(trial.model)).c_str(), trial.heldout_rms_px,
                trial.training_rms_px, trial.model == choice.model ? "  chosen" : "");
  }
  calibration::CameraFile file{found.camera,
                               now_utc(),
                               choice.fit.lens,
                               choice.model,
                               static_cast<int>(choice.used.size()),
                               choice.fit.rms_px,
                               choice.heldout_rms_px};
  const std::string json = calibration::camera_json(file);
  // Parsing rejects results that could not be read back, such as a lens whose distortion folds within the picture.
  TRY(calibration::parse_camera(json, options.out));
  TRY(write_file_atomically(options.out, std::string_view(json)));
  using L = calibration::MeasuredLens;
  const calibration::MeasuredLens& lens = file.lens;
  std::printf(
      "%s: focal length %.1f +- %.1f px, centre (%.1f, %.1f), from %zu views; directions to %.2f px or better\n",
      options.out.c_str(), lens.values[L::kFocal], std::sqrt(lens.covariance(L::kFocal, L::kFocal)),
      lens.values[L::kCentreU], lens.values[L::kCentreV], choice.used.size(), choice.worst_sigma_px);
  for (const std::string& remark : choice.remarks) std::printf("  - %s\n", remark.c_str());
  return Done{};
}

}  // namespace
}  // namespace cyclorama::camera_calibration

int main(int argc, char** argv) {
  cyclorama::Program program(
      "cyclorama-calibrate-camera",
      "Finds a camera's lens from pictures of a printed board (cyclorama calibrate-camera --print).");
  cyclorama::camera_calibration::Options options;
  cyclorama::camera_calibration::add_options(program.options(), &options);
  return program.run(
      argc, argv, [&](const cyclorama::StopSignal& stop) { return cyclorama::camera_calibration::run(options, stop); });
}
