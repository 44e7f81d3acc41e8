// SPDX-License-Identifier: Apache-2.0
#include "drivers/output/drm/probe_runner.h"

#include <utility>

#include "common/base/check.h"

namespace cyclorama::output {

ThreadProbeRunner::ThreadProbeRunner() : thread_([this] { run(); }) {}

ThreadProbeRunner::~ThreadProbeRunner() {
  {
    const std::lock_guard lock(mutex_);
    is_ending_ = true;
  }
  changed_.notify_one();
  thread_.join();
}

void ThreadProbeRunner::start(std::function<void()> job) {
  {
    const std::lock_guard lock(mutex_);
    CHECK(!job_);
    job_ = std::move(job);
  }
  changed_.notify_one();
}

bool ThreadProbeRunner::is_idle() {
  const std::lock_guard lock(mutex_);
  return !job_;
}

void ThreadProbeRunner::run() {
  std::unique_lock lock(mutex_);
  for (;;) {
    // Without a deadline, since the thread has nothing else to do and the destructor wakes it.
    changed_.wait(lock, [this] { return is_ending_ || job_; });
    if (is_ending_) return;
    lock.unlock();
    job_();
    lock.lock();
    job_ = nullptr;
  }
}

}  // namespace cyclorama::output
