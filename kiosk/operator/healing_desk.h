// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <string>

#include "common/base/result.h"
#include "common/wire/inspection.grpc.pb.h"
#include "common/wire/show.grpc.pb.h"

namespace cyclorama {

/// Asks the calibrator how the wall is kept in its place, and has it look anew. Thread-safe; calls block for at most
/// two seconds.
class HealingDesk {
 public:
  /// kInvalidArgument  the address is none. Does not dial yet.
  static Result<std::unique_ptr<HealingDesk>> make(const std::string& address);

  /// watched_json() of what the calibrator says now; "null" where it does not answer.
  [[nodiscard]] std::string json() const;
  /// kUnavailable, kTimedOut  nobody answers there, or nothing watches: says why.
  Status realign();
  /// Takes the last correction back that stands: which it was. kNotFound  there is none. Others alike.
  Result<std::string> undo();

 private:
  explicit HealingDesk(const std::shared_ptr<grpc::Channel>& channel);
  const std::unique_ptr<wire::Inspection::Stub> inspection_;
  const std::unique_ptr<wire::Healing::Stub> healing_;
};

/// {"sentence", "projectors": [{"name", "state", "reason", "off_px", "sigma_px", "corrections", "last_px", "last_s",
/// "wants_scan"}], "names": [], "history": [[s_ago, off_px or null of each]]}; "null" where nothing watches. What is no
/// number, or no text, is null.
[[nodiscard]] std::string watched_json(const wire::ProcessStatus& calibrator);

}  // namespace cyclorama
