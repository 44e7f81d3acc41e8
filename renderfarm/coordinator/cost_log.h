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

/// Writes what frames cost, one record per session, for cyclorama-bench-balance. A slow disk costs frames of
/// the record, never time of the coordinator. Thread-safe; one thread of its own.
class CostLog {
 public:
  /// Makes the folder. `notice` gets a sentence when a record cannot go on, on the log's thread.
  /// kSystem  errno says why.
  static Result<std::unique_ptr<CostLog>> open(std::filesystem::path folder,
                                               std::function<void(const std::string&)> notice);
  /// What waits is written first.
  ~CostLog();
  CostLog(const CostLog&) = delete;
  CostLog& operator=(const CostLog&) = delete;

  /// Complete frames whose nodes told the costs of all blocks; others are left out. Never waits.
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
  std::map<SessionId, std::unique_ptr<balance::CostRecorder>> records_;  ///< The thread's; null: it cannot be written.

  std::mutex mutex_;  ///< Guards the following.
  std::condition_variable changed_;
  std::deque<Waiting> waiting_;
  bool stopping_ = false;

  std::thread thread_;
};

}  // namespace cyclorama::coordinator
