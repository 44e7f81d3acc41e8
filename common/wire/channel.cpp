// SPDX-License-Identifier: Apache-2.0
#include "common/wire/channel.h"

#include <fmt/format.h>
#include <grpcpp/create_channel.h>
#include <grpcpp/security/credentials.h>
#include <grpcpp/security/server_credentials.h>
#include <grpcpp/server_builder.h>

#include <algorithm>
#include <array>
#include <future>
#include <utility>

namespace cyclorama {
namespace {

constexpr std::array<std::pair<ErrorCode, grpc::StatusCode>, 7> kCodes{{
    {ErrorCode::kInvalidArgument, grpc::StatusCode::INVALID_ARGUMENT},
    {ErrorCode::kNotFound, grpc::StatusCode::NOT_FOUND},
    {ErrorCode::kBusy, grpc::StatusCode::RESOURCE_EXHAUSTED},
    {ErrorCode::kUnavailable, grpc::StatusCode::UNAVAILABLE},
    {ErrorCode::kTimedOut, grpc::StatusCode::DEADLINE_EXCEEDED},
    {ErrorCode::kBadData, grpc::StatusCode::DATA_LOSS},
    {ErrorCode::kSystem, grpc::StatusCode::INTERNAL},
}};

Status check_address(const std::string& address) {
  if (!is_unix_socket(address)) TRY(parse_address(address));
  return Done{};
}

Error cannot_listen(const std::string& address) {
  if (is_unix_socket(address)) {
    return Error(ErrorCode::kBusy, fmt::format("cannot listen on {}: its folder is not there or not writable, or the "
                                               "path is over 107 bytes",
                                               address));
  }
  return Error(ErrorCode::kBusy, fmt::format("cannot listen on {}: the port is taken, or the address is not of this "
                                             "machine; stop the other program or choose another",
                                             address));
}

/// Parts of gRPC's messages about an untrusted peer, and the sentences that replace these messages.
constexpr std::array<std::pair<std::string_view, std::string_view>, 2> kDistrust{{
    {"certificate verify failed", "its certificate is not from this side's authority, or has expired"},
    {"Hostname Verification Check failed", "its certificate does not contain the address used to connect"},
}};

/// Returns why a call failed. If nobody listens, gRPC returns a long message with a percent-encoded address, of which
/// the last part suffices.
std::string reason_of(const grpc::Status& status) {
  const std::string& message = status.error_message();
  if (message.empty()) return "the peer gave no reason";
  for (const auto& [part, sentence] : kDistrust) {
    if (message.find(part) != std::string::npos) return std::string(sentence);
  }
  const std::size_t last = message.rfind(": ");
  if (!message.starts_with("failed to connect to all addresses") || last == std::string::npos) return message;
  return "it cannot be reached: " + message.substr(last + 2);
}

}  // namespace

grpc::Status to_grpc(const Error& error) {
  for (const auto& [ours, theirs] : kCodes) {
    if (ours == error.code()) return {theirs, error.message()};
  }
  return {grpc::StatusCode::UNKNOWN, error.message()};
}

Error from_grpc(const grpc::Status& status, std::string_view doing) {
  CHECK(!status.ok());
  ErrorCode code = ErrorCode::kUnavailable;  // For CANCELLED and UNKNOWN: the peer was lost.
  for (const auto& [ours, theirs] : kCodes) {
    if (theirs == status.error_code()) code = ours;
  }
  return Error(code, fmt::format("{}: {}", doing, reason_of(status)));
}

Result<std::shared_ptr<grpc::Channel>> make_channel(const std::string& address, const std::optional<TlsFiles>& tls) {
  TRY(check_address(address));
  std::shared_ptr<grpc::ChannelCredentials> credentials = grpc::InsecureChannelCredentials();
  if (tls) {
    TRY_ASSIGN(credentials, channel_credentials(*tls));
  }
  grpc::ChannelArguments arguments;
  arguments.SetMaxReceiveMessageSize(kMessageLimitBytes);
  arguments.SetInt(GRPC_ARG_INITIAL_RECONNECT_BACKOFF_MS, 100);
  arguments.SetInt(GRPC_ARG_MIN_RECONNECT_BACKOFF_MS, 2000);  // This is, in effect, the timeout of one attempt.
  arguments.SetInt(GRPC_ARG_MAX_RECONNECT_BACKOFF_MS, 500);
  arguments.SetInt(GRPC_ARG_KEEPALIVE_TIME_MS, 5000);
  arguments.SetInt(GRPC_ARG_KEEPALIVE_TIMEOUT_MS, 5000);
  arguments.SetInt(GRPC_ARG_HTTP2_MAX_PINGS_WITHOUT_DATA, 0);
  arguments.SetInt(GRPC_ARG_USE_LOCAL_SUBCHANNEL_POOL,
                   1);  // Gives the channel a connection of its own, so that a slow stream does not delay others.
  return grpc::CreateCustomChannel(address, credentials, arguments);
}

void wait_until_connected(grpc::Channel& channel, Duration time, const std::function<bool()>& is_over) {
  constexpr Duration kSlice = std::chrono::milliseconds(50);
  const SteadyClock clock;
  const TimePoint until = clock.now() + time;
  const bool was_connected = channel.GetState(true) == GRPC_CHANNEL_READY;
  while (clock.now() < until && !is_over()) {
    const grpc_connectivity_state state = channel.GetState(true);
    if (state == GRPC_CHANNEL_READY && !was_connected) return;
    channel.WaitForStateChange(state, std::chrono::system_clock::now() + std::min(kSlice, until - clock.now()));
  }
}

grpc::Status unreadable() {
  return {grpc::StatusCode::DATA_LOSS, "it sent a message that cannot be read; install the same version on both sides"};
}

grpc::Status finish_after_read(grpc::ClientContext& context, const std::function<grpc::Status()>& finish) {
  // Time for a busy computer to start a thread; an emulated one has taken more than one second.
  constexpr auto kAtOnce = std::chrono::seconds(10);
  std::future<grpc::Status> end = std::async(std::launch::async, finish);
  if (end.wait_for(kAtOnce) == std::future_status::ready) return end.get();
  context.TryCancel();
  end.wait();
  return unreadable();
}

Result<std::unique_ptr<WireServer>> WireServer::start(const std::string& address,
                                                      const std::vector<grpc::Service*>& services,
                                                      const ServerOptions& options) {
  TRY(check_address(address));
  std::shared_ptr<grpc::ServerCredentials> credentials = grpc::InsecureServerCredentials();
  if (options.tls) {
    TRY_ASSIGN(credentials, server_credentials(*options.tls, options.admit));
  }
  grpc::ServerBuilder builder;
  int port = 0;
  builder.AddListeningPort(address, credentials, &port);
  builder.SetMaxReceiveMessageSize(options.message_limit_bytes);
  if (options.calls_per_connection > 0) {
    builder.AddChannelArgument(GRPC_ARG_MAX_CONCURRENT_STREAMS, options.calls_per_connection);
  }
  // Without this, two coordinators on one port would share the clients at random.
  builder.AddChannelArgument(GRPC_ARG_ALLOW_REUSEPORT, 0);
  // A lost or frozen machine sends nothing; keep-alive ends its stream within 10 s.
  builder.AddChannelArgument(GRPC_ARG_KEEPALIVE_TIME_MS, 5000);
  builder.AddChannelArgument(GRPC_ARG_KEEPALIVE_TIMEOUT_MS, 5000);
  builder.AddChannelArgument(GRPC_ARG_HTTP2_MAX_PINGS_WITHOUT_DATA, 0);
  builder.AddChannelArgument(GRPC_ARG_HTTP2_MIN_RECV_PING_INTERVAL_WITHOUT_DATA_MS, 2000);
  // A connection whose peer sends nothing valid is closed soon, so that its descriptor is freed.
  builder.AddChannelArgument(GRPC_ARG_SERVER_HANDSHAKE_TIMEOUT_MS, 10'000);
  builder.AddChannelArgument(GRPC_ARG_MAX_CONNECTION_IDLE_MS, 300'000);
  if (options.tls) {
    // An open call continues, but the next one requires a new connection with the current certificate. A peer that was
    // revoked and has received a new certificate is therefore admitted without a restart.
    builder.AddChannelArgument(GRPC_ARG_MAX_CONNECTION_AGE_MS, 30'000);
  }
  for (grpc::Service* const service : services) builder.RegisterService(service);
  std::unique_ptr<grpc::Server> server = builder.BuildAndStart();
  if (server == nullptr || port == 0) return cannot_listen(address);
  if (is_unix_socket(address)) port = 0;
  return std::unique_ptr<WireServer>(new WireServer(std::move(server), port));
}

WireServer::~WireServer() { stop(Duration::zero()); }

void WireServer::stop(Duration grace) {
  // gRPC's deadlines use the system clock.
  server_->Shutdown(std::chrono::system_clock::now() +
                    std::chrono::duration_cast<std::chrono::system_clock::duration>(grace));
}

}  // namespace cyclorama
