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
#include "common/wire/inspection_service.h"

namespace cyclorama::healing {

/// Keeps the projectors registered while the show goes on:
///
///     lacks something ──calibration, cameras' poses──▶ watches ──hold()──▶ held ──▶ begins anew
///            ▲                                             │ a display or all cameras absent: waits, and reports it
///            └───────── another calibration applies ───────┘
///
/// 1. correction.json, which displays follow, is only ever replaced by a calibration that step() accepted.
/// 2. watch.json is written with it, and whenever the uncertainty has halved, so that another process resumes in the
///    same state, with the same certainty.
/// 3. Each correction is a line of FOLDER/corrections.log, with before and after (correction_log.h); the last can be
///    taken back.
/// 4. A file that cannot be written is reported as long as that lasts, counted (watch_unkept), and written at the next
///    step.
/// 5. A projector that cannot be watched, or a camera that cannot watch, is named with the remedy; the others are kept.
/// Runs one thread, with the lowest priority. Thread-safe.
class HealingLoop {
 public:
  struct Options {
    Duration period = std::chrono::milliseconds(250);
    structured_light::ExposureLimits exposure{};  ///< Used while cameras are placed.
    std::filesystem::path record{};               ///< Folder of the record; empty: nothing is recorded.
    std::filesystem::path installation_file{};    ///< Copied into the record.
    /// Called on the loop's thread for each line of the log; may be null.
    std::function<void(std::string)> on_line{};
    /// Called with the present activity, and whether that is well; may be null.
    std::function<void(std::string, bool)> tell{};
  };
  /// Starts the loop. Borrows the clock and the inspection.
  HealingLoop(Installation installation, std::filesystem::path folder, std::unique_ptr<ShowRooms> rooms,
              const Clock& clock, InspectionService* inspection, Options options);
  /// Ends within a step.
  ~HealingLoop();
  HealingLoop(const HealingLoop&) = delete;
  HealingLoop& operator=(const HealingLoop&) = delete;

  /// During its lifetime the loop leaves displays and cameras to a measurement of the wall.
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

  /// Errors: kUnavailable if nothing is watched, with the reason.
  Status realign();
  /// Takes back the last correction in force: what the cameras see now counts as its projector's right position.
  /// Returns which correction it was. Errors: kUnavailable if nothing is watched, with the reason; kNotFound if no
  /// correction is in force.
  Result<std::string> undo();
  /// Precondition: the caller holds the loop. Errors: those of place_cameras(); kNotFound if no camera watches, or
  /// there is no calibration.
  Result<std::vector<PlacedCamera>> place_cameras(std::stop_token stop);

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

  std::mutex working_;                  ///< Held during a step and by a Held; guards the two members below.
  std::unique_ptr<Watching> watching_;  ///< Null: not started yet, or stopped.
  std::string lacks_;                   ///< Reason why watching_ is null.
  std::atomic<int> holders_{0};
  std::mutex mutex_;
  std::condition_variable_any woken_;
  std::jthread thread_;  ///< Last member, so that the thread ends before what it uses.
};

}  // namespace cyclorama::healing
