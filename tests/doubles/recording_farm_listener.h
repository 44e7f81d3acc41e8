// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <condition_variable>
#include <mutex>
#include <string>
#include <utility>
#include <vector>

#include "renderfarm/client/farm_client.h"

namespace cyclorama {

/// Records everything that a farm sends. Thread-safe.
class RecordingFarmListener final : public client::FarmListener {
 public:
  struct Frame {
    wire::View view;
    std::vector<wire::Tile> tiles;
    wire::FrameEnd end;
  };
  struct Seen {
    int opened = 0;
    wire::SceneDescription scene;
    std::vector<std::string> reasons;
    std::vector<Frame> frames;  ///< Ended frames, complete or not.
  };

  [[nodiscard]] Seen seen() const {
    const std::lock_guard lock(mutex_);
    return seen_;
  }
  /// Waits until `enough` returns true; it is called at each event and periodically. Returns false at the deadline.
  template <typename Predicate>
  bool wait(Predicate&& enough, Duration limit = std::chrono::seconds(20)) {
    const TimePoint deadline = SteadyClock().now() + limit;
    std::unique_lock lock(mutex_);
    while (!enough(std::as_const(seen_))) {
      if (SteadyClock().now() >= deadline) return false;
      changed_.wait_for(lock, std::chrono::milliseconds(20));
    }
    return true;
  }

  void on_opened(const wire::SceneDescription& scene) override {
    change([&] {
      ++seen_.opened;
      seen_.scene = scene;
    });
  }
  void on_lost(const Error& reason) override {
    change([&] { seen_.reasons.push_back(reason.message()); });
  }
  void on_begin(const wire::View& view) override {
    open_ = Frame();
    open_.view = view;
  }
  void on_tile(wire::Tile tile) override { open_.tiles.push_back(std::move(tile)); }
  void on_end(const wire::FrameEnd& end) override {
    open_.end = end;
    change([&] { seen_.frames.push_back(std::move(open_)); });
  }

 private:
  template <typename Change>
  void change(Change&& make) {
    {
      const std::lock_guard lock(mutex_);
      make();
    }
    changed_.notify_all();
  }
  Frame open_;  ///< Client's thread only.
  mutable std::mutex mutex_;
  std::condition_variable changed_;
  Seen seen_;
};

}  // namespace cyclorama
