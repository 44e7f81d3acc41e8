// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <condition_variable>
#include <cstdint>
#include <deque>
#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <thread>

#include "common/base/result.h"
#include "renderfarm/balance/cost_record.h"
#include "renderfarm/coordinator/delegate.h"

namespace cyclorama::coordinator {

/// Writes the costs of frames, one record per session, for cyclorama-bench-balance. The coordinator never waits for the
/// disk; if it is slow, frames are omitted from the record. Thread-safe; owns one thread.
class CostLog {
 public:
  /// Creates the folder. `notice` receives a sentence when a record cannot be continued; it is called on the log's
  /// thread.
  /// Errors: kSystem with errno.
  static Result<std::unique_ptr<CostLog>> open(std::filesystem::path folder,
                                               std::function<void(const std::string&)> notice);
  /// Writes the queued frames first.
  ~CostLog();
  CostLog(const CostLog&) = delete;
  CostLog& operator=(const CostLog&) = delete;

  /// Queues a complete frame whose nodes reported the costs of all blocks; ignores other frames. Never waits.
  void add(const FrameReport& report);

 private:
  CostLog(std::filesystem::path folder, std::function<void(const std::string&)> notice);
  struct Waiting {
    SessionId session{};
    balance::RecordedFrame frame;
    balance::PictureSize size;
    std::vector<balance::MeasuredBlock> costs{};
  };
  void run();
  void write(const Waiting& frame);

  const std::filesystem::path folder_;
  const std::function<void(const std::string&)> notice_;
  std::map<SessionId, std::unique_ptr<balance::CostRecorder>> records_;  ///< Log's thread only. Null after an error.

  std::mutex mutex_;  ///< Guards the following.
  std::condition_variable changed_;
  std::deque<Waiting> waiting_;
  bool stopping_ = false;

  std::thread thread_;
};

}  // namespace cyclorama::coordinator
