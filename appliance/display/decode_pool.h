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

/// A few threads that decode tiles, first come first served. Who submits bounds the work. Thread-safe.
class DecodePool {
 public:
  using Job = std::function<void(JpegDecoder&)>;

  explicit DecodePool(int threads);
  /// Jobs that have not begun are destroyed unrun.
  ~DecodePool();
  DecodePool(const DecodePool&) = delete;
  DecodePool& operator=(const DecodePool&) = delete;

  void submit(Job job);

 private:
  void work(std::stop_token stop);

  std::mutex mutex_;
  std::condition_variable_any changed_;
  std::deque<Job> jobs_;
  std::vector<std::jthread> threads_;  // Last: they end before what they use.
};

}  // namespace cyclorama::display
