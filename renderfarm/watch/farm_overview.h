// SPDX-License-Identifier: Apache-2.0
/// What an operator sees of the farm at one moment: plain data, from the head to tables, metrics and pages.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

namespace cyclorama {

struct WatchedVisit {
  std::uint64_t id = 0;  ///< Never used twice while the head runs.
  std::string museum{};
  std::string scene{};
  double frames_per_second = 0.0;  ///< Of the last second or so; pictures at rest are not counted.
  int samples_per_pixel = 0;       ///< Of the last frame, in all.
  double scale = 1.0;              ///< Rendered over asked width.
  int width_px = 0;                ///< As rendered.
  int height_px = 0;
  double budget_ms = 0.0;  ///< Per frame; 0: each view says its own quality.
  double frame_ms = 0.0;   ///< Of the last frame: from the view's arrival to its end.
  double bytes_per_frame = 0.0;
  double balance_efficiency = 1.0;  ///< Mean load over largest load of the nodes, in the last frame.
  std::uint64_t frames = 0;         ///< Whole ones, since the visit was opened.
  std::uint64_t refined = 0;        ///< Pictures at rest with more samples.
  std::uint64_t late = 0;           ///< Given up at the deadline.
  std::uint64_t given_up = 0;       ///< For another reason.
};

struct WatchedNode {
  std::uint64_t id = 0;
  std::string name{};   ///< Need not be unique.
  std::string state{};  ///< "ready", "loading", "late", "stops" or "no scene".
  int threads = 0;
  double speed = 1.0;              ///< Of one thread: 1 is the first node's that was measured.
  std::size_t blocks = 0;          ///< Ordered and not yet ended.
  std::size_t blocks_waiting = 0;  ///< As the node tells: not yet begun.
  std::uint64_t memory_bytes = 0;
  double uptime_s = 0.0;
  double load_share = 0.0;            ///< Of the largest load in a frame, smoothed: all at 1 is a perfect balance.
  std::vector<std::string> scenes{};  ///< Loaded.
};

struct FarmOverview {
  std::vector<WatchedVisit> visits{};
  std::vector<WatchedNode> nodes{};
  std::map<std::string, std::size_t> scene_nodes{};  ///< How many nodes have each of the farm's scenes.
  bool healthy = false;
};

}  // namespace cyclorama
