// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <grpcpp/client_context.h>

#include <chrono>
#include <memory>
#include <string>

#include "common/base/result.h"
#include "common/wire/channel.h"
#include "common/wire/museum.grpc.pb.h"

namespace cyclorama::operations {

/// Calls one method of the tour at `address`; blocks for at most five seconds. `doing` describes it in errors, which
/// are those of the method in museum.proto.
template <typename Reply, typename Request>
Result<Reply> call_tour(const std::string& address, const char* doing, const Request& request,
                        grpc::Status (wire::Tour::Stub::*method)(grpc::ClientContext*, const Request&, Reply*)) {
  TRY_ASSIGN(const std::shared_ptr<grpc::Channel> channel, make_channel(address));
  const auto stub = wire::Tour::NewStub(channel);
  grpc::ClientContext context;
  context.set_deadline(std::chrono::system_clock::now() + std::chrono::seconds(5));
  Reply reply;
  const grpc::Status status = (stub.get()->*method)(&context, request, &reply);
  if (!status.ok()) return from_grpc(status, doing);
  return reply;
}

}  // namespace cyclorama::operations
