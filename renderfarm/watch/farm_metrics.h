// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <string>

#include "common/base/error.h"
#include "renderfarm/watch/farm_overview.h"

namespace cyclorama::watch {

/// Figures of one frame for the counters.
struct FrameFigures {
  enum class Outcome { kWhole, kRefined, kLate, kGivenUp };
  std::string museum{};
  Outcome outcome = Outcome::kWhole;
  std::size_t bytes = 0;
  std::uint64_t rays = 0;
  bool reassigned = false;  ///< True if other nodes rendered tiles that one node failed to deliver.
  int moved = 0;            ///< Number of blocks that an idle node took from others.
};

/// The farm's metrics in Prometheus' text format 0.0.4, made with prometheus-cpp. docs/reference/metrics.md lists them.
///
/// The number of series is bounded: museums beyond the first kMaxMuseums names count as "(others)", only the worst
/// session of each museum is shown, and nodes with the same name are numbered. Thread-safe.
class FarmMetrics {
 public:
  static constexpr std::size_t kMaxMuseums = 64;

  FarmMetrics();
  ~FarmMetrics();
  FarmMetrics(const FarmMetrics&) = delete;
  FarmMetrics& operator=(const FarmMetrics&) = delete;

  void add(const FrameFigures& frame);
  /// Adds the duration of one stage of a frame; see docs/reference/frame-timing.md.
  void add_stage(const std::string& stage, double seconds);
  void session_opened(const std::string& museum);
  void session_refused(ErrorCode reason);
  void node_sent_away();
  /// Records the bytes of scene files sent to nodes since the coordinator's start. To be called by only one thread.
  void scene_bytes_sent(std::uint64_t so_far);
  /// Replaces the previous overview.
  void show(FarmOverview overview);

  [[nodiscard]] std::string text() const;

 private:
  struct Series;
  std::unique_ptr<Series> series_;
};

inline constexpr const char* kMetricsType = "text/plain; version=0.0.4; charset=utf-8";

}  // namespace cyclorama::watch
