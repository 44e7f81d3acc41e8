// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "common/base/clock.h"
#include "drivers/output/drm/card.h"
#include "drivers/output/drm/hotplug_monitor.h"
#include "drivers/output/drm/probe_runner.h"

namespace cyclorama::output {

/// A card, and the connectors that it lights.
struct WatchedCard {
  const Card* card = nullptr;
  std::vector<std::uint32_t> lit{};  ///< Ids of connectors.
};

/// Reads the connectors of all cards again when something may have changed, without holding up the calling thread: a
/// probe takes tens of milliseconds per cable, during which the kernel also keeps others from reading connectors. So
/// the runner makes all readings.
///
///   hot-plug event, or ask()                        every connector is probed
///   every 5 s while a head is dark, or if the       dark connectors are probed; of lit ones only the kernel's present
///   kernel's events cannot be received              state is read
///
/// Borrows the cards, which must outlive it, and the clock. Thread-bound.
class ConnectorWatch {
 public:
  ConnectorWatch(std::unique_ptr<ProbeRunner> runner, const Clock& clock);

  /// Requests a reading as soon as possible, but not before `not_before`.
  void ask(TimePoint not_before);
  /// Begins a reading if one is due. `is_any_dark`: a head shows nothing, so that its connector is of interest.
  void step(bool is_any_dark, std::vector<WatchedCard> cards);
  /// Returns the reading that has ended since the last call, with one entry per card; nothing if none has.
  [[nodiscard]] std::optional<std::vector<Result<std::vector<Connector>>>> take();

 private:
  /// What the runner's job reads and writes.
  struct Reading {
    std::vector<WatchedCard> cards;
    bool is_full = false;
    std::vector<Result<std::vector<Connector>>> connectors;
  };

  const Clock& clock_;
  std::optional<HotplugMonitor> hotplug_;
  std::optional<TimePoint> asked_at_;
  TimePoint look_again_at_{};
  bool is_reading_ = false;
  Reading reading_;
  std::unique_ptr<ProbeRunner> runner_;  // Last member, since its destructor ends the job that uses the others.
};

}  // namespace cyclorama::output
