// SPDX-License-Identifier: Apache-2.0
/// cyclorama: the operator's command line.
#include <fmt/format.h>

#include <algorithm>
#include <cstdio>
#include <optional>
#include <string>
#include <vector>

#include "common/base/file.h"
#include "common/image/image_file.h"
#include "common/image/png.h"
#include "common/process/program.h"
#include "common/process/progress.h"
#include "kiosk/operator/calibrate_camera_command.h"
#include "kiosk/operator/calibrate_command.h"
#include "kiosk/operator/doctor_command.h"
#include "kiosk/operator/hours_command.h"
#include "kiosk/operator/realign_command.h"
#include "kiosk/operator/sign_stick_command.h"
#include "kiosk/operator/status_json.h"
#include "kiosk/operator/status_table.h"
#include "kiosk/operator/summary.h"
#include "kiosk/operator/tour_command.h"
#include "kiosk/operator/update_command.h"
#include "kiosk/operator/wand_command.h"

namespace cyclorama::operations {
namespace {

struct Options {
  std::vector<std::string> watches;
  std::optional<std::string> endpoints;
  std::optional<std::string> json;    // For `status`.
  std::string process, picture, out;  // For `picture` and `record`.
  double seconds = 30.0;              // For `record`, like the next three.
  double timeout_s = 180.0;
  double expect_frames = 1.0;
  std::optional<double> started_s;
  WandCommand wand;
  CalibrateCommand calibrate;
  RealignCommand realign;
  DoctorCommand doctor;
  SignStickCommand sign_stick;
  UpdateCommand update;
  HoursCommand hours;
  TourCommand tour;
  int exit_code = kExitOk;  // Exit code of a command that succeeded.
  CalibrateCameraCommand calibrate_camera;
};

constexpr int kColumns = 6;  // Columns of wall-over-time.png.
constexpr auto kBetweenLooks = std::chrono::milliseconds(250);

Duration seconds(double s) { return std::chrono::duration_cast<Duration>(std::chrono::duration<double>(s)); }

void add_watches(CLI::App& app, Options* options) {
  app.add_option("--watch", options->watches, "NAME=ADDRESS of a process; repeat it")->allow_extra_args(false);
  app.add_option("--endpoints", options->endpoints, "A file of [[watch]] tables, each with name and address");
}

void add_options(CLI::App& app, Options* options) {
  app.require_subcommand(1);
  CLI::App& status = *app.add_subcommand("status", "Show the state of every part as a table");
  add_watches(status, options);
  status.add_option("--json", options->json, "Also write it to this file, as the page's /status");
  CLI::App& picture = *app.add_subcommand("picture", "Save one live picture as PNG");
  add_watches(picture, options);
  picture.add_option("PROCESS", options->process, "Such as display")->required();
  picture.add_option("NAME", options->picture, "Such as projector/left; 'cyclorama status' lists them")->required();
  picture.add_option("--out", options->out, "The PNG to write")->required();
  CLI::App& record =
      *app.add_subcommand("record", "Record a visit: pictures and a summary; fails if any part did not work");
  add_watches(record, options);
  record.add_option("--seconds", options->seconds, "Duration, from the first presented frame on")
      ->check(CLI::Range(1.0, 86400.0))
      ->capture_default_str();
  record.add_option("--out", options->out, "The folder to write")->required();
  record.add_option("--expect-frames", options->expect_frames, "Fail with fewer frames")->capture_default_str();
  record.add_option("--timeout", options->timeout_s, "Seconds to wait for the first frame")->capture_default_str();
  record.add_option("--started", options->started_s,
                    "Start of the demo in seconds of Unix time: summary.json then has the "
                    "time to the first picture");
  options->wand.add_to(&app);
  options->calibrate.add_to(&app);
  options->realign.add_to(&app);
  options->update.add_to(&app);
  options->sign_stick.add_to(&app);
  options->hours.add_to(&app);
  options->tour.add_to(&app);
  add_watches(*options->doctor.add_to(&app), options);
  options->calibrate_camera.add_to(&app);
}

Status show_status(const Options& options, const std::vector<ProcessLink>& links) {
  std::vector<ProcessObservation> observations;
  for (const ProcessLink& link : links) observations.push_back(observe(link, {}));
  std::fputs(status_table(observations).c_str(), stdout);
  if (options.json) TRY(write_file_atomically(*options.json, std::string_view(status_json(observations))));
  const bool well =
      std::all_of(observations.begin(), observations.end(), [](const ProcessObservation& o) { return o.is_well(); });
  if (!well) return Error(ErrorCode::kUnavailable, "not every part is well");
  return Done{};
}

Status save_picture(const Options& options, const std::vector<ProcessLink>& links, const StopSignal& stop) {
  const auto link = std::find_if(links.begin(), links.end(),
                                 [&](const ProcessLink& l) { return l.endpoint().name == options.process; });
  if (link == links.end()) {
    return Error(ErrorCode::kNotFound,
                 fmt::format("'{}' is not watched; add --watch {}=ADDRESS", options.process, options.process));
  }
  auto answer = link->picture(options.picture);
  // A picture is rendered only after the first request for it.
  const TimePoint deadline = SteadyClock().now() + std::chrono::seconds(3);
  while (!answer && answer.error().code() == ErrorCode::kNotFound && SteadyClock().now() < deadline &&
         !stop.wait_until(SteadyClock().now() + kBetweenLooks)) {
    answer = link->picture(options.picture);
  }
  if (!answer) return std::move(answer).error();
  TRY_ASSIGN(const RgbImage image, JpegDecoder().decode(std::as_bytes(std::span(answer->jpeg())), kPhotoLimitPx));
  return write_png(options.out, image);
}

/// Polls until the first frame was presented; returns false on timeout or stop.
bool wait_for_first_frame(const Options& options, Recording* recording, const StopSignal& stop) {
  const TimePoint deadline = SteadyClock().now() + seconds(options.timeout_s);
  do {
    recording->look(SteadyClock().now());
    if (recording->frames() > 0.0) return true;
  } while (SteadyClock().now() < deadline && !stop.wait_until(SteadyClock().now() + kBetweenLooks));
  return false;
}

void record_span(const Options& options, Recording* recording, RecordedSpan* span, const StopSignal& stop) {
  Progress progress("recording the visit");
  const TimePoint begin = SteadyClock().now();
  const Duration whole = seconds(options.seconds);
  const double frames_before = recording->frames();
  const double poses_before = recording->poses();
  recording->begin();
  int ticks = 0;
  TimePoint now = begin;
  while (now - begin < whole && !stop.wait_until(std::min(now + kBetweenLooks, begin + whole))) {
    now = SteadyClock().now();
    recording->look(now);
    if (ticks < kColumns && (now - begin) * kColumns >= whole * (ticks + 1)) {
      recording->tick();
      ++ticks;
    }
    progress.update(std::min(1.0, to_seconds(now - begin) / options.seconds));
  }
  // The counts come from the newest answers of the processes.
  span->seconds = to_seconds(SteadyClock().now() - begin);
  span->frames = std::max(0.0, recording->frames() - frames_before);
  span->poses = std::max(0.0, recording->poses() - poses_before);
}

Status record(const Options& options, std::vector<ProcessLink> links, const StopSignal& stop) {
  Recording recording(std::move(links));
  RecordedSpan span;
  span.frames_wanted = std::max(options.expect_frames, 1.0);
  if (wait_for_first_frame(options, &recording, stop)) {
    if (options.started_s) {
      // The time of the start comes from a shell, so it is calendar time.
      const auto unix_time = std::chrono::system_clock::now().time_since_epoch();
      span.first_picture_s = std::chrono::duration<double>(unix_time).count() - *options.started_s;
    }
    record_span(options, &recording, &span, stop);
  }
  const std::vector<std::string> problems = problems_of(recording, span);
  const std::string summary = summary_json(recording, span, problems);
  TRY(write_recording(recording, options.out, summary));
  std::fputs(status_table_of(recording, span).c_str(), stdout);
  if (problems.empty()) return Done{};
  for (const std::string& problem : problems) std::fprintf(stderr, "  - %s\n", problem.c_str());
  return Error(ErrorCode::kUnavailable, fmt::format("{} thing{} did not work; see {}/summary.json", problems.size(),
                                                    problems.size() == 1 ? "" : "s", options.out));
}

Status run(Options& options, const CLI::App& app, const StopSignal& stop) {
  if (app.got_subcommand("wand")) return options.wand.run();
  if (app.got_subcommand("calibrate")) return options.calibrate.run(stop);
  if (app.got_subcommand("realign")) return options.realign.run();
  if (app.got_subcommand("update")) return options.update.run(stop);
  if (app.got_subcommand("sign-stick")) return options.sign_stick.run();
  if (app.got_subcommand("hours")) return options.hours.run(std::chrono::system_clock::now());
  if (app.got_subcommand("tour")) return options.tour.run(app);
  const bool is_doctor = app.got_subcommand("doctor");
  const bool is_usual = is_doctor || app.got_subcommand("status");
  if (is_usual && options.watches.empty() && !options.endpoints) options.watches = usual_watches();
  if (app.got_subcommand("calibrate-camera")) return options.calibrate_camera.run(app);
  std::vector<Endpoint> endpoints;
  // A render host with nodes only has no process that answers; `doctor` then checks only the machine.
  if (!is_usual || !options.watches.empty() || options.endpoints) {
    TRY_ASSIGN(endpoints, gather_endpoints(options.watches, options.endpoints));
  }
  TRY_ASSIGN(std::vector<ProcessLink> links, make_links(endpoints));
  if (is_doctor) return options.doctor.run(links, &options.exit_code);
  if (app.got_subcommand("status")) return show_status(options, links);
  if (app.got_subcommand("picture")) return save_picture(options, links, stop);
  return record(options, std::move(links), stop);
}

}  // namespace
}  // namespace cyclorama::operations

int main(int argc, char** argv) {
  cyclorama::Program program("cyclorama",
                             "The operator's command line: watches a running visit, calibrates the "
                             "wall, and prints wands.");
  cyclorama::operations::Options options;
  cyclorama::operations::add_options(program.options(), &options);
  const int code = program.run(argc, argv, [&](const cyclorama::StopSignal& stop) {
    return cyclorama::operations::run(options, program.options(), stop);
  });
  return code == cyclorama::kExitOk ? options.exit_code : code;
}
