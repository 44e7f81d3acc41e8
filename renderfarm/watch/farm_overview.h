// SPDX-License-Identifier: Apache-2.0
/// The farm's state at one moment: plain data for tables, metrics and pages.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

namespace cyclorama::watch {

struct WatchedSession {
  std::uint64_t id = 0;  ///< Unique while the coordinator runs.
  std::string museum{};
  std::string scene{};
  double frames_per_second = 0.0;  ///< Rate over about the last second, without pictures at rest.
  int samples_per_pixel = 0;       ///< Total samples of the last frame.
  double scale = 1.0;              ///< Rendered width over requested width.
  int width_px = 0;                ///< Width of the rendered picture.
  int height_px = 0;
  double budget_ms = 0.0;  ///< Budget per frame; 0 if each view states its quality.
  double frame_ms = 0.0;   ///< Time of the last frame, from the view's arrival to the frame's end.
  double bytes_per_frame = 0.0;
  double balance_efficiency = 1.0;  ///< Mean load over largest load of the nodes in the last frame.
  std::uint64_t frames = 0;         ///< Complete frames since the session was opened.
  std::uint64_t refined = 0;        ///< Refinements of pictures at rest.
  std::uint64_t late = 0;           ///< Frames given up at the deadline.
  std::uint64_t given_up = 0;       ///< Frames given up for other reasons.
  /// Source of the light in the session's moving pictures, such as "light 3f2a91c4 on 2 of 2 nodes" or "paths".
  std::string light{};
};

struct WatchedNode {
  std::uint64_t id = 0;
  std::string name{};   ///< Need not be unique.
  std::string state{};  ///< "ready", "loading", "late", "stops" or "no scene".
  int threads = 0;
  double speed = 1.0;              ///< Speed of one thread, relative to the first measured node.
  std::size_t blocks = 0;          ///< Blocks that are ordered and have not ended.
  std::size_t blocks_waiting = 0;  ///< Blocks that the node reported as not yet begun.
  std::uint64_t memory_bytes = 0;
  double uptime_s = 0.0;
  /// Load of the node over the largest load in a frame, smoothed; with perfect balance it is 1 for all nodes.
  double load_share = 0.0;
  std::vector<std::string> scenes{};  ///< Names of the loaded scenes.
  /// Light that the node has, such as "grotto: 3f2a91c4", or computes or will compute, such as "grotto: 42 %, 3 min
  /// left".
  std::vector<std::string> light{};
};

struct FarmOverview {
  std::vector<WatchedSession> sessions{};
  std::vector<WatchedNode> nodes{};
  std::map<std::string, std::size_t> scene_nodes{};  ///< Number of nodes that have each of the farm's scenes.
  bool healthy = false;
};

}  // namespace cyclorama::watch
