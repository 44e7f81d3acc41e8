// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <condition_variable>
#include <mutex>
#include <string>
#include <vector>

#include "appliance/display/pattern_wall.h"
#include "common/base/result.h"
#include "common/wire/calibration.grpc.pb.h"
#include "drivers/output/output.h"

namespace cyclorama::display {

/// What calibration.proto's PatternScreen promises, between its one stream and the presenter. Pictures are decoded on
/// gRPC's threads. Thread-safe, but tend().
class PatternService final : public wire::PatternScreen::Service {
 public:
  /// `heads`: the output's, in order. Borrows the mailbox. A call without an order for `idle` is ended: whoever turns
  /// the turntable by hand may take his time, but a calibration that hangs must not keep the wall from visitors. A head
  /// that shows nothing for `timeout` is away.
  PatternService(std::vector<output::HeadMode> heads, PatternMailbox* mailbox, Duration idle,
                 Duration timeout = std::chrono::seconds(10))
      : heads_(std::move(heads)), mailbox_(*mailbox), idle_(idle), timeout_(timeout) {}

  /// Hears from the presenter, frees what it is done with, and ends a call that is idle. By one thread, at each
  /// refresh.
  void tend();
  /// The presenter is about to end: nobody waits for it any more.
  void stop();
  /// Whether patterns are shown in the show's place.
  [[nodiscard]] bool is_open() const { return is_open_; }

 private:
  using Stream = grpc::ServerReaderWriter<wire::PatternShown, wire::PatternOrder>;
  grpc::Status ShowPatterns(grpc::ServerContext* context, Stream* stream) override;
  grpc::Status serve(grpc::ServerContext* context, Stream* stream);
  Status take(const wire::PatternOrder& order, std::vector<PatternWall::Head>* heads) const;
  std::uint64_t put(bool is_open, std::vector<PatternWall::Head> heads);
  bool read(grpc::ServerContext* context, Stream* stream, wire::PatternOrder* ret);
  Result<TimePoint> wait_for(std::uint64_t order, const grpc::ServerContext& context);

  const std::vector<output::HeadMode> heads_;
  PatternMailbox& mailbox_;
  const Duration idle_;
  const Duration timeout_;
  std::atomic<bool> is_open_{false};
  std::uint64_t order_ = 0;  // Of the newest wall; the one stream's.
  std::mutex mutex_;         // Guards the rest; never taken by the present thread.
  PatternsShown shown_;
  bool stops_ = false;
  grpc::ServerContext* waiting_ = nullptr;  // The call that waits for an order,
  TimePoint waits_since_{};                 // and since when.
  std::condition_variable changed_;
};

}  // namespace cyclorama::display
