// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <condition_variable>
#include <deque>
#include <functional>
#include <mutex>
#include <thread>
#include <vector>

#include "common/image/jpeg.h"

namespace cyclorama::display {

/// A few threads that decode tiles in the order of submission. The queue is unbounded: the caller limits the work.
/// Thread-safe.
class DecodePool {
 public:
  using Job = std::function<void(JpegDecoder&)>;

  explicit DecodePool(int threads);
  /// Destroys jobs that have not begun, without running them.
  ~DecodePool();
  DecodePool(const DecodePool&) = delete;
  DecodePool& operator=(const DecodePool&) = delete;

  void submit(Job job);

 private:
  void work(std::stop_token stop);

  std::mutex mutex_;
  std::condition_variable_any changed_;
  std::deque<Job> jobs_;
  std::vector<std::jthread> threads_;  // Last member, so that the threads end before what they use.
};

}  // namespace cyclorama::display
