// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <condition_variable>
#include <filesystem>
#include <functional>
#include <memory>
#include <mutex>
#include <string>
#include <thread>

#include "common/base/clock.h"
#include "common/base/result.h"
#include "renderfarm/watch/farm_metrics.h"

namespace cyclorama::watch {

/// Writes the metrics into a file for node_exporter's textfile collector, for farms without a listener. A reader sees
/// the old text or the new one, never a mixture. The destructor removes the file. Thread: `metrics`, which alone
/// accesses the disk after start().
class MetricsFile {
 public:
  static constexpr Duration kPeriod = std::chrono::seconds(10);

  /// Writes the file once before it returns. Keeps a reference to `metrics`. Calls `notice`, on the thread `metrics`,
  /// when writing fails and when it works again. Errors: those of write_file_atomically().
  static Result<std::unique_ptr<MetricsFile>> start(std::filesystem::path path, const FarmMetrics& metrics,
                                                    std::function<void(const std::string&)> notice,
                                                    Duration period = kPeriod);
  ~MetricsFile();
  MetricsFile(const MetricsFile&) = delete;
  MetricsFile& operator=(const MetricsFile&) = delete;

 private:
  MetricsFile(std::filesystem::path path, const FarmMetrics& metrics, std::function<void(const std::string&)> notice,
              Duration period);
  void run();

  const std::filesystem::path path_;
  const FarmMetrics& metrics_;
  const std::function<void(const std::string&)> notice_;
  const Duration period_;
  std::mutex mutex_;
  std::condition_variable changed_;
  bool stopping_ = false;  ///< Guarded by mutex_.
  std::thread thread_;     ///< Last member, because the thread uses all others.
};

}  // namespace cyclorama::watch
