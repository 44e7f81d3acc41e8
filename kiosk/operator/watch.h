// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <condition_variable>
#include <future>
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include "common/base/clock.h"
#include "kiosk/operator/observation.h"

namespace cyclorama::operations {

/// Polls all processes, so that each gets two requests a second however many pages are open. Thread-safe. Threads: one
/// per process, named after it, polling twice a second; a process that hangs delays no other.
class Watch {
 public:
  explicit Watch(std::vector<ProcessLink> links);
  ~Watch();
  Watch(const Watch&) = delete;
  Watch& operator=(const Watch&) = delete;

  /// Returns the observations in the order of the links.
  [[nodiscard]] std::vector<ProcessObservation> observations() const;
  /// Returns ProcessLink::picture(), with at most ten requests a second for one picture from all callers together.
  /// Errors: kNotFound also for a process that is not watched.
  Result<std::shared_ptr<const wire::Picture>> picture(const std::string& process, const std::string& name);
  /// Calls ProcessLink::steer(). Errors: kNotFound if no tour is watched.
  Status steer(const wire::SteerRequest& request) const;

 private:
  using Picture = Result<std::shared_ptr<const wire::Picture>>;
  /// Pages that request a picture while a request is in flight wait for the same answer, at most as long as that call
  /// may take.
  struct Shown {
    std::shared_future<Picture> answer;
    TimePoint asked_at{};
    [[nodiscard]] bool serves(TimePoint now) const;
  };
  void look(std::size_t index);
  [[nodiscard]] const ProcessLink* find(const std::string& process) const;

  const std::vector<ProcessLink> links_;
  mutable std::mutex mutex_;  ///< Guards the following.
  std::condition_variable changed_;
  bool stopping_ = false;
  std::vector<ProcessObservation> observations_;
  std::map<std::string, Shown> pictures_;

  std::vector<std::thread> threads_;
};

}  // namespace cyclorama::operations
