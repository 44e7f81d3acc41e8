// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <string>

#include "common/base/error.h"
#include "renderfarm/watch/farm_overview.h"

namespace cyclorama {

/// What one frame was, for the counters.
struct FrameFigures {
  enum class Outcome { kWhole, kRefined, kLate, kGivenUp };
  std::string museum{};
  Outcome outcome = Outcome::kWhole;
  std::size_t bytes = 0;
  std::uint64_t rays = 0;
  bool given_again = false;  ///< Others made what a node owed.
  int moved = 0;             ///< Blocks that a node that was done took from others.
};

/// The farm's numbers in Prometheus' text format 0.0.4, on prometheus-cpp. docs/reference/metrics.md lists them.
///
/// Series are bounded: museums beyond the first kMostMuseums names are counted as "(others)", of several visits of one
/// museum the worst is shown, and nodes of one name are numbered. Thread-safe.
class FarmMetrics {
 public:
  static constexpr std::size_t kMostMuseums = 64;

  FarmMetrics();
  ~FarmMetrics();
  FarmMetrics(const FarmMetrics&) = delete;
  FarmMetrics& operator=(const FarmMetrics&) = delete;

  void add(const FrameFigures& frame);
  /// One step of a frame's way: docs/reference/frame-timing.md.
  void add_stage(const std::string& stage, double seconds);
  void visit_opened(const std::string& museum);
  void visit_refused(ErrorCode reason);
  void node_sent_away();
  /// Of scenes' files, to nodes, since the head's start. By one thread.
  void scene_bytes_sent(std::uint64_t so_far);
  /// Takes the place of what was shown before.
  void show(FarmOverview overview);

  [[nodiscard]] std::string text() const;

 private:
  struct Series;
  std::unique_ptr<Series> series_;
};

inline constexpr const char* kMetricsType = "text/plain; version=0.0.4; charset=utf-8";

}  // namespace cyclorama
