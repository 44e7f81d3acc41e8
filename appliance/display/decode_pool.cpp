// SPDX-License-Identifier: Apache-2.0
#include "appliance/display/decode_pool.h"

#include <utility>

namespace cyclorama::display {

DecodePool::DecodePool(int threads) {
  for (int i = 0; i < threads; ++i) threads_.emplace_back([this](std::stop_token stop) { work(std::move(stop)); });
}

DecodePool::~DecodePool() {
  for (std::jthread& thread : threads_) thread.request_stop();
}

void DecodePool::submit(Job job) {
  {
    const std::lock_guard lock(mutex_);
    jobs_.push_back(std::move(job));
  }
  changed_.notify_one();
}

void DecodePool::work(std::stop_token stop) {
  JpegDecoder decoder;
  for (;;) {
    std::unique_lock lock(mutex_);
    // The wait ends when the pool's stop token is set.
    if (!changed_.wait(lock, stop, [this] { return !jobs_.empty(); }) || stop.stop_requested()) return;
    Job job = std::move(jobs_.front());
    jobs_.pop_front();
    lock.unlock();
    job(decoder);
  }
}

}  // namespace cyclorama::display
