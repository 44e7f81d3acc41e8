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

/// Keeps the wall in its place while the show goes on:
///
///     lacks something ──calibration, cameras' places──▶ watches ──hold()──▶ held ──▶ begins anew
///            ▲                                             │ a display or all cameras away: waits, and says so
///            └───────── another calibration counts ────────┘
///
/// 1. correction.json, which displays follow, is only ever replaced by a calibration that step() accepted.
/// 2. watch.json is written with it, and when all has become surer by half, so that another process goes on where this
///    one ended, and as sure.
/// 3. Each correction is a line of FOLDER/corrections.log, with before and after (correction_log.h); the last can be
///    taken back.
/// 4. What cannot be written is said for as long as that lasts, counted (watch_unkept), and written at the next step.
/// 5. Who cannot be watched, or cannot watch, is named with the remedy; the others are kept.
///
/// Threads: one, which gives way to all others. Thread-safe.
class HealingLoop {
 public:
  struct Options {
    Duration period = std::chrono::milliseconds(250);
    structured_light::ExposureLimits exposure{};    ///< While cameras are placed.
    std::filesystem::path record{};                 ///< Empty: nothing is recorded.
    std::filesystem::path installation_file{};      ///< For the record.
    std::function<void(std::string)> on_line{};     ///< For the log; on the loop's thread; may be null.
    std::function<void(std::string, bool)> tell{};  ///< What it does now, and whether that is well; may be null.
  };
  /// Begins. Borrows the clock and the inspection.
  HealingLoop(Installation installation, std::filesystem::path folder, std::unique_ptr<ShowRooms> rooms,
              const Clock& clock, InspectionService* inspection, Options options);
  /// Ends within a step.
  ~HealingLoop();
  HealingLoop(const HealingLoop&) = delete;
  HealingLoop& operator=(const HealingLoop&) = delete;

  /// While it lives the loop has let go of displays and cameras: the wall is measured. Blocks for a step.
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

  /// kUnavailable  nothing is watched: why.
  Status realign();
  /// Takes the last correction back that stands: what is seen now counts as its projector's place. Says which it was.
  /// kUnavailable  nothing is watched: why.     kNotFound  no correction stands.
  Result<std::string> undo();
  /// Precondition: the caller holds it. Errors of place_cameras(); kNotFound  no camera watches, or no calibration.
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

  std::mutex working_;                  ///< Held while a step is made, and by who holds the loop; guards the two below.
  std::unique_ptr<Watching> watching_;  ///< Null: not yet, or no longer.
  std::string lacks_;                   ///< Then why.
  std::atomic<int> holders_{0};
  std::mutex mutex_;
  std::condition_variable_any woken_;
  std::jthread thread_;  ///< Last: it ends before what it uses.
};

}  // namespace cyclorama::healing
