// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <string>

#include "common/base/result.h"
#include "common/wire/inspection.grpc.pb.h"
#include "common/wire/show.grpc.pb.h"

namespace cyclorama::operations {

/// Reports the calibrator's continuous alignment of the projectors, and triggers a new one. Thread-safe; calls block
/// for at most two seconds.
class HealingController {
 public:
  /// Errors: kInvalidArgument if the address is invalid. Does not connect yet.
  static Result<std::unique_ptr<HealingController>> make(const std::string& address);

  /// Returns watched_json() of the calibrator's present status; "null" if it does not answer.
  [[nodiscard]] std::string json() const;
  /// Aligns the projectors again. Errors: kUnavailable, kTimedOut, with the reason, if the calibrator does not answer
  /// or does not watch the wall.
  Status realign();
  /// Undoes the last correction in effect and returns its description. Errors: kNotFound if there is none; others are
  /// those of realign().
  Result<std::string> undo();

 private:
  explicit HealingController(const std::shared_ptr<grpc::Channel>& channel);
  const std::unique_ptr<wire::Inspection::Stub> inspection_;
  const std::unique_ptr<wire::Healing::Stub> healing_;
};

/// Returns {"sentence", "projectors": [{"name", "state", "reason", "off_px", "sigma_px", "corrections", "last_px",
/// "last_s", "wants_scan"}], "names": [], "history": [[s_ago, off_px or null of each]]}; "null" if the calibrator does
/// not watch the wall. A cell of the wrong type is null.
[[nodiscard]] std::string watched_json(const wire::ProcessStatus& calibrator);

}  // namespace cyclorama::operations
