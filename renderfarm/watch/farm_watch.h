// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <memory>
#include <string>

#include "common/wire/inspection_service.h"
#include "renderfarm/watch/metrics_file.h"
#include "renderfarm/watch/watch_options.h"
#include "renderfarm/watch/watch_server.h"

namespace cyclorama::watch {

/// The coordinator's metrics and pictures, over HTTP and as a file, as far as the options enable them. Thread-bound,
/// except for the returned objects.
class FarmWatch {
 public:
  /// Keeps a reference to `inspection`. Nothing listens before start().
  explicit FarmWatch(InspectionService& inspection) : inspection_(inspection) {}

  /// Starts what the options enable. `notice` may be called on another thread. Errors: those of validate(WatchOptions),
  /// WatchServer, MetricsFile and Access.
  Status start(const WatchOptions& options, const std::function<void(const std::string&)>& notice);
  void stop();

  [[nodiscard]] FarmMetrics& metrics() { return metrics_; }
  /// Returns null if nobody can watch; pictures then need not be kept.
  [[nodiscard]] SessionPictures* pictures() { return server_ ? &pictures_ : nullptr; }
  [[nodiscard]] int port() const { return server_ ? server_->port() : 0; }

 private:
  InspectionService& inspection_;
  FarmMetrics metrics_;
  SessionPictures pictures_;
  std::unique_ptr<MetricsFile> file_;
  std::unique_ptr<WatchServer> server_;
};

}  // namespace cyclorama::watch
