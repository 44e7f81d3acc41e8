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

/// Settings for the distribution of scenes to nodes that have no copy.
struct DistributionOptions {
  FileServer::Options files{};
  std::filesystem::path digests{};  ///< File in which the digests are kept across restarts; empty disables it.
};

struct CoordinatorOptions {
  std::vector<FarmScene> scenes{};     ///< At least one; the first is the default.
  std::string museums = "[::1]:7401";  ///< Listening address for museums; port 0 takes a free port.
  std::string nodes = "[::1]:7402";    ///< Listening address for nodes.
  std::string inspect{};               ///< Listening address of the inspection service; empty disables it.
  balance::BalanceStrategy strategy = balance::BalanceStrategy::kCostMapStealing;
  CoordinatorLimits limits{};
  trust::TrustOptions trust{};
  watch::WatchOptions watch{};
  std::string record{};  ///< Folder for the cost records that cyclorama-bench-balance reads; empty disables them.
  DistributionOptions distribution{};
  std::filesystem::path updates{};  ///< Folder of the appliances' images (see UpdateStore); empty disables updates.
  std::filesystem::path renewals{};  ///< Folder of requests for certificates (see Renewals); empty disables them.
};

/// Checks that names, paths and addresses are usable, and that addresses beyond this machine are served only with TLS.
/// Errors: kInvalidArgument, naming the faulty value.
Status validate(const CoordinatorOptions& options);

/// The farm's coordinator as a running service: gRPC streams around CoordinatorState. Threads: `coordinator` (the loop
/// that owns CoordinatorState), `scenes` (reads the scenes to be distributed, at startup), `files` (reads the files to
/// be sent), `audit` (writes to disk), and gRPC's own threads, which only pass messages on. Thread-safe.
class Coordinator {
 public:
  using Notice = std::function<void(const std::string& sentence, const NoticeAbout& about)>;

  /// Starts the service. `notice` receives sentences for the log, on the coordinator's thread and on the file threads.
  /// Errors: those of WireServer::start(), Gatekeeper::open() and FarmWatch::start().
  static Result<std::unique_ptr<Coordinator>> start(CoordinatorOptions options, Notice notice);
  ~Coordinator();
  Coordinator(const Coordinator&) = delete;
  Coordinator& operator=(const Coordinator&) = delete;

  [[nodiscard]] int museum_port() const;
  [[nodiscard]] int node_port() const;
  [[nodiscard]] int inspect_port() const;  ///< 0 if the service is disabled or its address is a Unix socket.
  [[nodiscard]] int watch_port() const;    ///< HTTP port; 0 if the service is disabled.
  /// Returns the time of the loop's last iteration; a healthy loop iterates at least every 100 ms.
  [[nodiscard]] TimePoint alive_at() const;
  /// Returns the bytes of scene files sent to nodes so far.
  [[nodiscard]] std::uint64_t sent_file_bytes() const;
  /// Returns one sentence for the operator.
  [[nodiscard]] std::string state() const;

  /// Ends all streams with UNAVAILABLE, waits briefly for the peers, and joins the threads. Idempotent.
  void stop();

 private:
  class Loop;
  explicit Coordinator(std::unique_ptr<Loop> loop);
  std::unique_ptr<Loop> loop_;
};

}  // namespace cyclorama::coordinator
