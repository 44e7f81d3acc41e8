// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/client/certificate_client.h"

#include <grpcpp/client_context.h>

#include <chrono>

#include "common/wire/certificates.grpc.pb.h"
#include "common/wire/channel.h"

namespace cyclorama::client {
namespace {

constexpr auto kDeadline = std::chrono::seconds(10);

}  // namespace

Result<std::string> renew_at_farm(const std::vector<std::string>& coordinators, const TlsFiles& tls,
                                  const std::string& request_pem) {
  wire::RenewRequest request;
  request.set_request_pem(request_pem);
  Error last(ErrorCode::kInvalidArgument, "no address of a farm is given");
  for (const std::string& coordinator : coordinators) {
    TRY_ASSIGN(const auto channel, make_channel(coordinator, tls));
    grpc::ClientContext context;
    context.set_deadline(std::chrono::system_clock::now() + kDeadline);
    wire::RenewReply reply;
    const grpc::Status status = wire::Certificates::NewStub(channel)->Renew(&context, request, &reply);
    if (status.ok()) return reply.certificate_pem();
    // A coordinator without this service is too old for it.
    if (status.error_code() == grpc::StatusCode::UNIMPLEMENTED) {
      return Error(ErrorCode::kNotFound, "this farm renews no certificates; ask its operator for the next bundle");
    }
    last = from_grpc(status, "requesting the next certificate from the farm");
    if (last.code() != ErrorCode::kUnavailable && last.code() != ErrorCode::kTimedOut) break;
  }
  return last;
}

}  // namespace cyclorama::client
