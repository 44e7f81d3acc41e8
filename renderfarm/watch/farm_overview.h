// SPDX-License-Identifier: Apache-2.0
/// State of the farm at one moment: plain data for tables, metrics and pages.
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
  double frames_per_second = 0.0;  ///< Over about the last second; pictures at rest are not counted.
  int samples_per_pixel = 0;       ///< Total of the last frame.
  double scale = 1.0;              ///< Rendered width over requested width.
  int width_px = 0;                ///< Width of the rendered picture.
  int height_px = 0;
  double budget_ms = 0.0;  ///< Per frame; 0 if each view states its own quality.
  double frame_ms = 0.0;   ///< Last frame, from the view's arrival to the frame's end.
  double bytes_per_frame = 0.0;
  double balance_efficiency = 1.0;  ///< Mean load over largest load of the nodes, in the last frame.
  std::uint64_t frames = 0;         ///< Complete frames since the session was opened.
  std::uint64_t refined = 0;        ///< Pictures at rest with more samples.
  std::uint64_t late = 0;           ///< Given up at the deadline.
  std::uint64_t given_up = 0;       ///< Given up for another reason.
  /// Source of the light in its moving pictures, such as "light 3f2a91c4 on 2 of 2 nodes" or "paths".
  std::string light{};
};

struct WatchedNode {
  std::uint64_t id = 0;
  std::string name{};   ///< Need not be unique.
  std::string state{};  ///< "ready", "loading", "late", "stops" or "no scene".
  int threads = 0;
  double speed = 1.0;              ///< Speed of one thread, relative to the first measured node.
  std::size_t blocks = 0;          ///< Ordered and not yet ended.
  std::size_t blocks_waiting = 0;  ///< Reported by the node as not yet begun.
  std::uint64_t memory_bytes = 0;
  double uptime_s = 0.0;
  /// Part of the largest load in a frame, smoothed: 1 for all nodes is a perfect balance.
  double load_share = 0.0;
  std::vector<std::string> scenes{};  ///< Loaded scenes.
  /// Scenes whose light it has, such as "grotto: 3f2a91c4", computes ahead or is about to: "grotto: 42 %, 3 min left".
  std::vector<std::string> light{};
};

struct FarmOverview {
  std::vector<WatchedSession> sessions{};
  std::vector<WatchedNode> nodes{};
  std::map<std::string, std::size_t> scene_nodes{};  ///< Number of nodes that have each of the farm's scenes.
  bool healthy = false;
};

}  // namespace cyclorama::watch
