// SPDX-License-Identifier: Apache-2.0
#include "appliance/healing/healing_loop.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <pthread.h>

#include <algorithm>
#include <span>
#include <utility>

#include "appliance/healing/correction_log.h"
#include "common/base/give_way.h"

namespace cyclorama::healing {
namespace {

constexpr Duration kTryAgainAfter = std::chrono::seconds(1);
/// Longest time for a step, with its waits for cameras and displays, each of which has a timeout of seconds.
constexpr Duration kStepTimeout = std::chrono::minutes(10);
constexpr Duration kKeepEvery = std::chrono::minutes(10);
constexpr int kGivesWay = 10;

}  // namespace

/// State that exists only while the wall is watched.
struct HealingLoop::Watching {
  Watching(HealingStart from, ContinuousCalibrator with, HealingHealth how, std::unique_ptr<ShowRoom> in,
           std::filesystem::file_time_type at)
      : show(std::move(from.show)),
        cameras(std::move(from.cameras)),
        left_out(std::move(from.troubles)),
        calibrator(std::move(with)),
        health(std::move(how)),
        room(std::move(in)),
        calibrated_at(at) {}
  calibration::ShowFile show;
  std::vector<std::size_t> cameras;   ///< Indices into the room's cameras, in the order of `show`'s.
  std::vector<std::string> left_out;  ///< Cameras that are left out, with the reason.
  ContinuousCalibrator calibrator;
  HealingHealth health;
  std::unique_ptr<ShowRoom> room;
  std::filesystem::file_time_type calibrated_at;
  std::optional<ShowRecorder> recorder;
  std::optional<TimePoint> kept_at;
  double kept_sigma_px = 0.0;  ///< Uncertainty of the saved state; the state is saved again when it has halved.
  bool wants_realignment = false;
  std::string unkept;  ///< Reason why the last correction was not written; retried at each step.
};

HealingLoop::HealingLoop(Installation installation, std::filesystem::path folder, std::unique_ptr<ShowRooms> rooms,
                         const Clock& clock, InspectionService* inspection, Options options)
    : installation_(std::move(installation)),
      folder_(std::move(folder)),
      rooms_(std::move(rooms)),
      clock_(clock),
      inspection_(*inspection),
      options_(std::move(options)),
      lacks_("it has only begun"),
      thread_([this](const std::stop_token& stop) {
        pthread_setname_np(pthread_self(), "healing");
        give_way(kGivesWay);
        run(stop);
      }) {}

HealingLoop::~HealingLoop() = default;

HealingLoop::Held::Held(HealingLoop* loop) : loop_(*loop) {
  ++loop_.holders_;
  working_ = std::unique_lock(loop_.working_);
  loop_.watching_.reset();
  loop_.lacks_ = "the wall is being measured";
  loop_.say("does not watch: the wall is being measured", true);
}

HealingLoop::Held::~Held() {
  loop_.lacks_ = "it has only begun";
  loop_.liveness_.expect_by(loop_.clock_.now() + kStepTimeout);
  --loop_.holders_;
}

void HealingLoop::run(const std::stop_token& stop) {
  while (!stop.stop_requested()) {
    const TimePoint begun = clock_.now();
    liveness_.expect_by(begun + kStepTimeout);
    Duration pause = options_.period;
    {
      const std::lock_guard lock(working_);
      if (holders_ == 0) turn();
      if (watching_ == nullptr) pause = kTryAgainAfter;
    }
    const Duration left = std::max<Duration>(pause - (clock_.now() - begun), std::chrono::milliseconds(10));
    std::unique_lock lock(mutex_);
    woken_.wait_for(lock, stop, left, [] { return false; });
  }
}

/// Does one step, or attempts to begin.
void HealingLoop::turn() {
  if (watching_ != nullptr && watching_->calibrated_at != calibrated_at()) watching_.reset();
  if (watching_ == nullptr) {
    if (const Status begun = begin(); !begun) {
      lacks_ = begun.error().message();
      return say("does not watch the wall: " + lacks_, begun.error().code() == ErrorCode::kNotFound);
    }
  }
  if (const Status stepped = step(); !stepped) {
    // The learned room stays in watch.json.
    lacks_ = stepped.error().message();
    watching_.reset();
    say("cannot watch the wall: " + lacks_, false);
  }
}

Status HealingLoop::begin() {
  const auto at = calibrated_at();
  const std::vector<std::string> troubles = rooms_->troubles();
  // Troubles exist only if cameras were named. The wall should then be watched, so a lack of cameras is a fault.
  if (rooms_->cameras().empty() && !troubles.empty())
    return Error(ErrorCode::kUnavailable, fmt::format("{}", fmt::join(troubles, "; ")));
  TRY_ASSIGN(HealingStart begun, healing_start(folder_, installation_, rooms_->cameras()));
  begun.troubles.insert(begun.troubles.begin(), troubles.begin(), troubles.end());
  const calibration::ShowFile& show = begun.show;
  const int factor = rooms_->picture_factor();
  RecordStart start{applied_room(show, installation_, factor), learned_room(show, installation_, factor),
                    static_cast<std::uint32_t>(factor)};
  std::optional<ShowRecorder> recorder;
  if (!options_.record.empty()) {
    const auto folder = options_.record / utc_now();
    const std::uintmax_t used = record_bytes(options_.record);
    auto recording =
        used < kMaxRecordBytes
            ? ShowRecorder::begin(folder, options_.installation_file, start, kMaxRecordBytes - used)
            : Error(ErrorCode::kBusy, "the records in that folder have reached their maximum size; remove some");
    if (recording) {
      recorder = *std::move(recording);
      // Reads the start back, since rounding changes the last bits of a rotation.
      TRY_ASSIGN(const ShowRecord read, ShowRecord::open(folder));
      start = read.start();
    } else if (options_.on_line) {
      // Corrections do not depend on the record, which is only for engineers.
      options_.on_line("nothing is recorded: " + recording.error().message());
    }
  }
  TRY_ASSIGN(ContinuousCalibrator calibrator, start.begin());
  std::vector<std::string> names;
  for (const InstalledProjector& projector : installation_.projectors) names.push_back(projector.name);
  TRY_ASSIGN(std::unique_ptr<ShowRoom> room, rooms_->open());
  watching_ =
      std::make_unique<Watching>(std::move(begun), std::move(calibrator),
                                 HealingHealth(std::move(names), static_cast<double>(factor)), std::move(room), at);
  watching_->recorder = std::move(recorder);
  return Done{};
}

Status HealingLoop::step() {
  Watching& now = *watching_;
  std::vector<std::string> troubles = now.left_out;
  TRY_ASSIGN(ShowMoment moment, now.room->next(&troubles));
  // The calibrator's camera indices count only the cameras that it has.
  std::erase_if(moment.seen, [&](const CameraPicture& picture) {
    return std::ranges::find(now.cameras, picture.camera) == now.cameras.end();
  });
  for (CameraPicture& picture : moment.seen) {
    picture.camera = static_cast<std::size_t>(std::ranges::find(now.cameras, picture.camera) - now.cameras.begin());
  }
  if (std::exchange(now.wants_realignment, false)) {
    now.calibrator.realign();
    if (now.recorder) end_record_unless(now.recorder->add_realignment());
  }
  const ShowReport report = now.calibrator.step(moment);
  if (now.recorder) {
    end_record_unless(now.recorder->add(moment, report));
  }
  now.health.take(report, moment.now);
  if (options_.on_line) {
    for (const std::string& line : report.log) options_.on_line(line);
  }
  keep(report);
  inspection_.set_table(now.health.projectors(moment.now));
  inspection_.set_table(now.health.history(moment.now));
  inspection_.add_stage_time("watch", clock_.now() - moment.now);
  for (const Correction& c : report.corrections) {
    inspection_.count(c.is_bump ? "watch_bumps" : "watch_drifts");
  }
  std::string sentence = now.health.sentence();
  if (!now.unkept.empty()) sentence += "; displays are not told of corrections: " + now.unkept;
  for (const std::string& trouble : troubles) sentence += "; " + trouble;
  say(sentence, now.health.is_well() && troubles.empty() && now.unkept.empty());
  return Done{};
}

/// Copies the calibrator's state into the file's structure.
void HealingLoop::take_over() {
  Watching& now = *watching_;
  const calibration::ShowCalibration& applied = now.calibrator.applied();
  const calibration::ShowCalibration& believed = now.calibrator.believed();
  for (std::size_t i = 0; i < now.show.projectors.size(); ++i)
    now.show.projectors[i].applied = applied.projectors[i].T_room_projector;
  for (std::size_t i = 0; i < now.show.cameras.size(); ++i)
    now.show.cameras[i].T_room_camera = believed.cameras[i].T_room_camera;
  if (const auto learned = now.calibrator.learned()) put_learned(*learned, &now.show);
}

void HealingLoop::keep(const ShowReport& report) {
  Watching& now = *watching_;
  take_over();
  const bool has_corrected = !report.corrections.empty();
  const bool is_calm = std::ranges::all_of(
      report.projectors, [](const auto& p) { return p.hold == HoldReason::kNone || p.hold == HoldReason::kUnplaced; });
  double sigma_px = 0.0;
  for (const ProjectorHealth& one : report.projectors) {
    if (one.hold != HoldReason::kUnplaced) sigma_px = std::max(sigma_px, one.sigma_px);
  }
  const bool is_due = !now.kept_at || clock_.now() > *now.kept_at + kKeepEvery || sigma_px < 0.5 * now.kept_sigma_px;
  std::vector<LoggedCorrection> corrections;
  const double pixels = rooms_->picture_factor();
  for (const Correction& c : report.corrections) {
    corrections.push_back({utc_now(), c.is_bump ? "bump" : "drift", c.projector, pixels * c.moved_px,
                           pixels * c.sigma_px, c.before, c.after});
  }
  log_corrections(folder_, corrections);
  const bool is_unkept = !now.unkept.empty();
  if (!has_corrected && !is_unkept && !(is_calm && now.calibrator.is_settled() && is_due)) return;
  now.kept_at = clock_.now();
  now.kept_sigma_px = sigma_px;
  const Status written = write_state(has_corrected || is_unkept);
  const std::string why = written ? "" : written.error().message();
  if (!written) inspection_.count("watch_unkept");
  if (!written && why != now.unkept && options_.on_line) options_.on_line("what was learned cannot be written: " + why);
  now.unkept = why;
}

/// Ends the record if `kept` is an error; the correction of the wall continues.
void HealingLoop::end_record_unless(const Status& kept) {
  if (kept) return;
  if (options_.on_line) options_.on_line("recording ends: " + kept.error().message());
  watching_->recorder.reset();
}

Status HealingLoop::write_state(bool with_correction) {
  // Leaves out the light: it is read from colours.json at each start, and older versions do not accept such a member.
  calibration::ShowFile show = watching_->show;
  for (calibration::ShowFile::Projector& projector : show.projectors) projector.light.reset();
  if (with_correction) {
    calibration::ShowFile correction = show;
    correction.cameras.clear();
    for (calibration::ShowFile::Projector& projector : correction.projectors) {
      projector.learned.reset();
      projector.unplaced.clear();
    }
    TRY(calibration::write_show(folder_ / calibration::kCorrectionFile, correction));
  }
  return calibration::write_show(folder_ / calibration::kWatchFile, show);
}

Status HealingLoop::realign() {
  // Does not wait for the lock, which a Held may keep for minutes.
  if (holders_ > 0) return Error(ErrorCode::kUnavailable, "the wall is being measured");
  const std::lock_guard lock(working_);
  if (watching_ == nullptr) return Error(ErrorCode::kUnavailable, "the wall is not watched: " + lacks_);
  watching_->wants_realignment = true;
  return Done{};
}

Result<std::string> HealingLoop::undo() {
  if (holders_ > 0) return Error(ErrorCode::kUnavailable, "the wall is being measured");
  const std::lock_guard lock(working_);
  if (watching_ == nullptr) return Error(ErrorCode::kUnavailable, "the wall is not watched: " + lacks_);
  Watching& now = *watching_;
  std::vector<RigidTransform<frame::Room, frame::Projector>> applied;
  for (const calibration::ShowProjector& projector : now.calibrator.applied().projectors)
    applied.push_back(projector.T_room_projector);
  const auto last = last_correction(folder_, applied);
  if (!last) return Error(ErrorCode::kNotFound, "no correction stands that could be undone");
  // Builds the pose from the values that a record stores, so that a replay has the same bits: rounding changes the last
  // bits of a rotation.
  TRY(now.calibrator.put_back(last->projector, {last->before.rotation(), last->before.translation()}));
  if (now.recorder) end_record_unless(now.recorder->add_put_back(last->projector, last->before));
  const LoggedCorrection undone{utc_now(),      "undone",    last->projector, last->moved_px,
                                last->sigma_px, last->after, last->before};
  log_corrections(folder_, std::span(&undone, 1));
  take_over();
  const Status written = write_state(true);
  now.unkept = written ? "" : written.error().message();
  inspection_.count("watch_undone");
  std::string sentence = fmt::format(
      "projector '{}' is drawn for as before the {} of {}, which moved it by {:.2f} px; how it is seen now "
      "counts as its place",
      installation_.projectors[last->projector].name, last->kind, last->at, last->moved_px);
  if (options_.on_line) options_.on_line(sentence);
  return sentence;
}

Result<std::vector<PlacedCamera>> HealingLoop::place_cameras(std::stop_token stop) {
  if (rooms_->cameras().empty()) {
    const std::vector<std::string> troubles = rooms_->troubles();
    return Error(ErrorCode::kNotFound,
                 troubles.empty() ? kNoCameraWatches : fmt::format("{}", fmt::join(troubles, "; ")));
  }
  TRY_ASSIGN(const calibration::Calibration calibration, corrected_calibration(folder_, installation_));
  TRY_ASSIGN(PlacementDevices devices, rooms_->open_for_placement());
  TRY_ASSIGN(const std::vector<PlacedCamera> placed,
             cyclorama::healing::place_cameras(rooms_->cameras(), devices, calibration, installation_,
                                               options_.exposure, stop));
  TRY(save_camera_poses(folder_, installation_, placed));
  return placed;
}

void HealingLoop::say(const std::string& sentence, bool is_well) {
  inspection_.set_fact("watch", sentence);
  if (options_.tell) options_.tell(sentence, is_well);
}

std::filesystem::file_time_type HealingLoop::calibrated_at() const {
  std::error_code ignored;
  return std::filesystem::last_write_time(folder_ / "calibration.json", ignored);
}

}  // namespace cyclorama::healing
