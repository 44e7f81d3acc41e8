// SPDX-License-Identifier: Apache-2.0
/// gRPC conventions of this project: addresses, limits, keep-alive, and errors that keep their codes.
#pragma once

#include <grpcpp/channel.h>
#include <grpcpp/client_context.h>
#include <grpcpp/server.h>
#include <grpcpp/support/status.h>

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "common/base/address.h"
#include "common/base/clock.h"
#include "common/base/result.h"
#include "common/wire/tls.h"

namespace cyclorama {

/// Maximum size of a message; many times a tile of a 16k-wide frame at full quality.
inline constexpr int kMessageLimitBytes = 16 << 20;

/// Maps ErrorCode to a gRPC status one to one; the message is unchanged.
[[nodiscard]] grpc::Status to_grpc(const Error& error);
/// Inverse of to_grpc(). `doing` describes this side's action, such as "opening the session". Precondition:
/// !status.ok().
[[nodiscard]] Error from_grpc(const grpc::Status& status, std::string_view doing);

/// Returns a channel to HOST:PORT, such as "[::1]:7401", or to a socket in the file system, such as "unix:/run/x.sock".
/// It connects on first use, for at most 2 s, sends keep-alives every 5 s, and reconnects with a back-off of 0.1 to 2
/// s. Without `tls` nothing is encrypted. Thread-safe once made. Errors: those of parse_address(); with `tls`, also
/// those of channel_credentials().
Result<std::shared_ptr<grpc::Channel>> make_channel(const std::string& address,
                                                    const std::optional<TlsFiles>& tls = std::nullopt);

/// Waits for `time` and lets the channel connect meanwhile: gRPC 1.51 continues connecting only while a thread waits
/// for the channel, a failed call does not wait, and TLS takes several rounds. Returns earlier once the channel is
/// connected, and within 50 ms when `is_over` returns true.
void wait_until_connected(grpc::Channel& channel, Duration time, const std::function<bool()>& is_over);

/// Returns a DATA_LOSS status: the peer sent something that is not a valid message.
grpc::Status unreadable();

/// Finishes a client's stream whose Read() returned false. `finish` is the stream's Finish(): it returns at once if the
/// peer has ended the call, but never if the peer sent an invalid message; in that case the call is cancelled after ten
/// seconds, and the result is unreadable().
grpc::Status finish_after_read(grpc::ClientContext& context, const std::function<grpc::Status()>& finish);

/// Settings of a server.
struct ServerOptions {
  std::optional<TlsFiles> tls{};
  Admission admit{};  ///< With TLS: decides on every call; may be empty.
  int message_limit_bytes = kMessageLimitBytes;
  int calls_per_connection = 0;  ///< Maximum number of concurrent calls; further calls wait at the peer. 0: no limit.
};

/// A listening server. It must be destroyed or stopped before its services are destroyed. Thread-safe.
class WireServer {
 public:
  /// Starts serving on `address`; port 0 selects a free one, and an existing socket file is replaced. Borrows the
  /// services until stop(). Errors: kInvalidArgument for an invalid address; kBusy if the port is taken; with TLS, also
  /// those of server_credentials().
  static Result<std::unique_ptr<WireServer>> start(const std::string& address,
                                                   const std::vector<grpc::Service*>& services,
                                                   const ServerOptions& options = {});
  ~WireServer();
  WireServer(const WireServer&) = delete;
  WireServer& operator=(const WireServer&) = delete;

  /// Returns the port; 0 for a socket in the file system.
  [[nodiscard]] int port() const { return port_; }
  /// Lets open calls end by themselves for at most `grace`, then cancels them. Blocks. May be called twice.
  void stop(Duration grace);

 private:
  WireServer(std::unique_ptr<grpc::Server> server, int port) : server_(std::move(server)), port_(port) {}
  std::unique_ptr<grpc::Server> server_;
  int port_;
};

}  // namespace cyclorama
