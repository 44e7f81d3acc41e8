// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/watch/farm_watch.h"

namespace cyclorama::watch {

Status FarmWatch::start(const WatchOptions& options, const std::function<void(const std::string&)>& notice) {
  TRY(validate(options));
  if (!options.metrics_file.empty()) {
    TRY_ASSIGN(file_, MetricsFile::start(options.metrics_file, metrics_, notice));
  }
  if (options.address.empty()) return Done{};
  Access access;
  if (!options.token_file.empty()) {
    TRY_ASSIGN(access, Access::read(options.token_file));
  }
  TRY_ASSIGN(server_, WatchServer::start(options.address, std::move(access),
                                         {[this] { return inspection_.status(); }, metrics_, pictures_}));
  return Done{};
}

void FarmWatch::stop() {
  if (server_ != nullptr) server_->stop();
  file_ = nullptr;
}

}  // namespace cyclorama::watch
