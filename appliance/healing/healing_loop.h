// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <condition_variable>
#include <filesystem>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <stop_token>
#include <string>
#include <thread>

#include "appliance/healing/healing_health.h"
#include "appliance/healing/healing_start.h"
#include "appliance/healing/show_record.h"
#include "common/base/liveness.h"
#include "common/wire/inspection_service.h"

namespace cyclorama::healing {

/// Keeps the projectors registered while the show goes on:
///
///     lacks something ──calibration, cameras' poses──▶ watches ──hold()──▶ held ──▶ begins anew
///            ▲                                             │ a display or all cameras absent: waits, and reports it
///            └───────── another calibration applies ───────┘
///
/// 1. correction.json, which displays follow, is written only after a correction that the calibrator accepted, or by
///    undo().
/// 2. watch.json is written with it, every ten minutes, and whenever the uncertainty has halved, so that another
///    process resumes with the same state and uncertainty.
/// 3. Each correction is a line of FOLDER/corrections.log (correction_log.h), with the poses before and after it;
///    undo() undoes the last one.
/// 4. A file that cannot be written is reported, counted as watch_unkept, and tried again at each step until it can be
///    written.
/// 5. A projector that cannot be watched, or a camera that cannot watch, is reported with the remedy; the others go on.
/// Runs one thread, at low priority. Thread-safe.
class HealingLoop {
 public:
  struct Options {
    Duration period = std::chrono::milliseconds(250);
    structured_light::ExposureLimits exposure{};  ///< Used while cameras are placed.
    std::filesystem::path record{};               ///< Folder of the record; empty: nothing is recorded.
    std::filesystem::path installation_file{};    ///< Copied into the record.
    /// Called on the loop's thread for each line of the log; may be null.
    std::function<void(std::string)> on_line{};
    /// Called with a sentence on the present state, and whether all is well; may be null.
    std::function<void(std::string, bool)> tell{};
  };
  /// Starts the loop. Borrows the clock and the inspection.
  HealingLoop(Installation installation, std::filesystem::path folder, std::unique_ptr<ShowRooms> rooms,
              const Clock& clock, InspectionService* inspection, Options options);
  /// Stops the thread; waits for the step in progress.
  ~HealingLoop();
  HealingLoop(const HealingLoop&) = delete;
  HealingLoop& operator=(const HealingLoop&) = delete;

  /// While it exists, the loop uses no display and no camera, so that the wall can be measured.
  class Held {
   public:
    explicit Held(HealingLoop* loop);
    ~Held();
    Held(const Held&) = delete;
    Held& operator=(const Held&) = delete;

   private:
    HealingLoop& loop_;
    std::unique_lock<std::mutex> working_;
  };
  [[nodiscard]] std::unique_ptr<Held> hold() { return std::make_unique<Held>(this); }

  /// Requests a realignment at the next step: see ContinuousCalibrator::realign(). Errors: kUnavailable if nothing is
  /// watched, with the reason.
  Status realign();
  /// Undoes the last correction in force: its projector is drawn for the former pose again, and the projector's present
  /// position counts as right. Returns a sentence about the correction, for operators. Errors: kUnavailable if nothing
  /// is watched, with the reason; kNotFound if no correction is in force.
  Result<std::string> undo();
  /// Places all cameras and saves their poses. Precondition: the caller has a Held. Errors: those of
  /// healing::place_cameras(); kNotFound if no camera watches, or there is no calibration.
  Result<std::vector<PlacedCamera>> place_cameras(std::stop_token stop);
  /// False while a step takes far longer than any should: the thread, a camera or a display hangs. While it is held,
  /// this is true.
  [[nodiscard]] bool moves_on() const { return holders_ > 0 || liveness_.is_alive(clock_.now()); }

 private:
  struct Watching;
  void run(const std::stop_token& stop);
  void turn();
  Status begin();
  Status step();
  void keep(const ShowReport& report);
  void end_record_unless(const Status& kept);
  Status write_state(bool with_correction);
  void take_over();
  void say(const std::string& sentence, bool is_well);
  [[nodiscard]] std::filesystem::file_time_type calibrated_at() const;

  const Installation installation_;
  const std::filesystem::path folder_;
  const std::unique_ptr<ShowRooms> rooms_;
  const Clock& clock_;
  InspectionService& inspection_;
  const Options options_;

  std::mutex working_;                  ///< Locked during a step and by a Held; guards the two members below.
  std::unique_ptr<Watching> watching_;  ///< Null before the start, and while the wall is not watched.
  std::string lacks_;                   ///< Reason why watching_ is null.
  std::atomic<int> holders_{0};
  Liveness liveness_;
  std::mutex mutex_;
  std::condition_variable_any woken_;
  std::jthread thread_;  ///< Last member, so that it ends before the others are destroyed.
};

}  // namespace cyclorama::healing
