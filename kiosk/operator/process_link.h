// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <string>

#include "common/base/result.h"
#include "common/wire/inspection.grpc.pb.h"
#include "common/wire/museum.grpc.pb.h"
#include "kiosk/operator/endpoint.h"

namespace cyclorama::operations {

/// Connection to one watched process, which may come and go between calls. Every call blocks for at most two seconds
/// (Inspection's deadline). Thread-safe.
class ProcessLink {
 public:
  /// Does not connect yet. Errors: kInvalidArgument if the address is invalid.
  static Result<ProcessLink> make(Endpoint endpoint);

  [[nodiscard]] const Endpoint& endpoint() const { return endpoint_; }
  /// Errors: kUnavailable if the process is away, kTimedOut if it hangs.
  Result<wire::ProcessStatus> status() const;
  /// Errors: kNotFound if there is no such picture (yet): it is made after the first request; others are those of
  /// status().
  Result<wire::Picture> picture(const std::string& name) const;
  /// For the tour only. Errors: kInvalidArgument for a value beyond [-1, 1]; others are those of status().
  Status steer(const wire::SteerRequest& request) const;

 private:
  ProcessLink(Endpoint endpoint, std::shared_ptr<grpc::Channel> channel);
  Endpoint endpoint_;
  std::shared_ptr<grpc::Channel> channel_;
  std::unique_ptr<wire::Inspection::Stub> inspection_;
  std::unique_ptr<wire::Tour::Stub> tour_;
};

Result<std::vector<ProcessLink>> make_links(const std::vector<Endpoint>& endpoints);

/// Explains an absent process and the remedy to people, in one or two sentences.
[[nodiscard]] std::string away_sentence(const Endpoint& endpoint, const Error& error);

}  // namespace cyclorama::operations
