// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <string>

#include "common/base/result.h"
#include "common/wire/inspection.grpc.pb.h"
#include "common/wire/museum.grpc.pb.h"
#include "kiosk/operator/endpoint.h"

namespace cyclorama {

/// One watched process, asked over the wire. It may come and go: each call finds out. Every call blocks for at most two
/// seconds (Inspection's deadline). Thread-safe.
class ProcessLink {
 public:
  /// Does not dial yet. kInvalidArgument  the address is none.
  static Result<ProcessLink> make(Endpoint endpoint);

  [[nodiscard]] const Endpoint& endpoint() const { return endpoint_; }
  /// kUnavailable, kTimedOut  it is away or hangs.
  Result<wire::ProcessStatus> status() const;
  /// kNotFound  no such picture (yet): it is made once somebody has asked.     Else as status().
  Result<wire::Picture> picture(const std::string& name) const;
  /// The tour only. kInvalidArgument  a value beyond [-1, 1].     Else as status().
  Status steer(const wire::SteerRequest& request) const;

 private:
  ProcessLink(Endpoint endpoint, std::shared_ptr<grpc::Channel> channel);
  Endpoint endpoint_;
  std::shared_ptr<grpc::Channel> channel_;
  std::unique_ptr<wire::Inspection::Stub> inspection_;
  std::unique_ptr<wire::Tour::Stub> tour_;
};

Result<std::vector<ProcessLink>> make_links(const std::vector<Endpoint>& endpoints);

/// For people: what an absent process means, and what helps. One or two sentences.
[[nodiscard]] std::string away_sentence(const Endpoint& endpoint, const Error& error);

}  // namespace cyclorama
