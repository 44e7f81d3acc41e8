// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/watch/metrics_file.h"

#include <fmt/format.h>

#include "common/base/file.h"

namespace cyclorama::watch {

Result<std::unique_ptr<MetricsFile>> MetricsFile::start(std::filesystem::path path, const FarmMetrics& metrics,
                                                        std::function<void(const std::string&)> notice,
                                                        Duration period) {
  TRY(write_file_atomically(path, metrics.text()));
  return std::unique_ptr<MetricsFile>(new MetricsFile(std::move(path), metrics, std::move(notice), period));
}

MetricsFile::MetricsFile(std::filesystem::path path, const FarmMetrics& metrics,
                         std::function<void(const std::string&)> notice, Duration period)
    : path_(std::move(path)), metrics_(metrics), notice_(std::move(notice)), period_(period), thread_([this] {
        run();
      }) {}

MetricsFile::~MetricsFile() {
  {
    const std::lock_guard lock(mutex_);
    stopping_ = true;
  }
  changed_.notify_all();
  thread_.join();
  std::error_code ignored;
  std::filesystem::remove(path_, ignored);  // Otherwise the last numbers would look current after a stop.
}

void MetricsFile::run() {
  bool works = true;
  for (std::unique_lock lock(mutex_); !changed_.wait_for(lock, period_, [this] { return stopping_; });) {
    lock.unlock();
    const Status written = write_file_atomically(path_, metrics_.text());
    if (!written && works)
      notice_(written.error().message() + ", ignoring; the metrics are out of date until writing works again");
    if (written && !works) notice_(fmt::format("'{}' is written again", path_.string()));
    works = written.has_value();
    lock.lock();
  }
}

}  // namespace cyclorama::watch
