// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <condition_variable>
#include <functional>
#include <mutex>
#include <thread>

namespace cyclorama::output {

/// Runs one job at a time beside the calling thread: probes of connectors, which take as long as a cable does. Its
/// methods are for one thread.
class ProbeRunner {
 public:
  virtual ~ProbeRunner() = default;
  /// Precondition: is_idle().
  virtual void start(std::function<void()> job) = 0;
  /// True if no job is under way; then everything that the last one wrote is visible. Never waits for a job.
  [[nodiscard]] virtual bool is_idle() = 0;

 protected:
  ProbeRunner() = default;
  ProbeRunner(const ProbeRunner&) = delete;
  ProbeRunner& operator=(const ProbeRunner&) = delete;
};

/// Runs jobs on a thread of its own. The destructor waits for the job that is under way.
class ThreadProbeRunner final : public ProbeRunner {
 public:
  ThreadProbeRunner();
  ~ThreadProbeRunner() override;
  void start(std::function<void()> job) override;
  [[nodiscard]] bool is_idle() override;

 private:
  void run();

  std::mutex mutex_;  // Guards the two members below; never held while a job runs.
  std::function<void()> job_;
  bool is_ending_ = false;
  std::condition_variable changed_;
  std::thread thread_;
};

}  // namespace cyclorama::output
