// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <string>
#include <thread>
#include <vector>

#include "common/base/clock.h"
#include "common/base/result.h"
#include "renderfarm/balance/balancer.h"
#include "renderfarm/coordinator/coordinator_state.h"
#include "renderfarm/coordinator/file_server.h"
#include "renderfarm/trust/gatekeeper.h"
#include "renderfarm/watch/watch_options.h"

namespace cyclorama::coordinator {

/// How scenes reach nodes that have no copy of them.
struct DistributionOptions {
  FileServer::Options files{};
  std::filesystem::path digests{};  ///< Where the digests of files are kept over restarts; empty: nowhere.
};

struct CoordinatorOptions {
  std::vector<FarmScene> scenes{};     ///< At least one; the first is the default.
  std::string museums = "[::1]:7401";  ///< Where museums dial; port 0 takes a free one.
  std::string nodes = "[::1]:7402";    ///< Where nodes dial.
  std::string inspect{};               ///< Where the operator looks; empty: nowhere.
  balance::BalanceStrategy strategy = balance::BalanceStrategy::kCostMapStealing;
  CoordinatorLimits limits{};
  trust::TrustOptions trust{};
  watch::WatchOptions watch{};
  std::string record{};  ///< Folder for what frames cost, for cyclorama-bench-balance; empty: not kept.
  DistributionOptions distribution{};
  std::filesystem::path updates{};  ///< Of appliances' images, as UpdateStore; empty: none.
};

/// That names, paths and addresses can work, and that nothing listens to the world without TLS. kInvalidArgument names
/// the culprit.
Status validate(const CoordinatorOptions& options);

/// The farm's coordinator as a running service: gRPC's streams around CoordinatorState. Threads: `coordinator` (the one loop that CoordinatorState
/// lives on), `scenes` (reads the scenes that the coordinator hands out, at the start), `files` (reads what it sends of them),
/// `audit` (waits for the disk), and gRPC's own, which only carry messages. Thread-safe.
class Coordinator {
 public:
  using Notice = std::function<void(const std::string& sentence, const NoticeAbout& about)>;

  /// `notice` gets sentences for the log, on the coordinator's thread and those of its files. kInvalidArgument, kBusy  as
  /// WireServer::start(). Else as Gatekeeper::open() and FarmWatch::start().
  static Result<std::unique_ptr<Coordinator>> start(CoordinatorOptions options, Notice notice);
  ~Coordinator();
  Coordinator(const Coordinator&) = delete;
  Coordinator& operator=(const Coordinator&) = delete;

  [[nodiscard]] int museum_port() const;
  [[nodiscard]] int node_port() const;
  [[nodiscard]] int inspect_port() const;  ///< 0: none, or a socket in the file system.
  [[nodiscard]] int watch_port() const;    ///< Of HTTP; 0: none.
  /// When the loop last went round: at least every 100 ms while it is healthy.
  [[nodiscard]] TimePoint alive_at() const;
  /// Of scenes' files, to nodes, so far.
  [[nodiscard]] std::uint64_t sent_file_bytes() const;
  /// One sentence for the operator.
  [[nodiscard]] std::string state() const;

  /// Tells everybody that the coordinator stops (UNAVAILABLE), waits for them a moment, and joins. Idempotent.
  void stop();

 private:
  class Loop;
  explicit Coordinator(std::unique_ptr<Loop> loop);
  std::unique_ptr<Loop> loop_;
};

}  // namespace cyclorama::coordinator
