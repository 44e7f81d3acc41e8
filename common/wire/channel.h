// SPDX-License-Identifier: Apache-2.0
/// gRPC conventions of this project: addresses, limits, keep-alive, and errors that keep their code.
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
/// Precondition: !status.ok(). `doing` describes this side's action: "opening the session".
[[nodiscard]] Error from_grpc(const grpc::Status& status, std::string_view doing);

/// Returns a channel to "[::1]:7401" (or a name and port), or to a socket in the file system, "unix:/run/x.sock". It
/// connects on first use, for at most 2 s, sends keep-alives every 5 s and reconnects with a back-off of 0.1 to 2 s.
/// Without `tls` nothing is encrypted. Thread-safe once made. Errors: kInvalidArgument as parse_address(); with `tls`,
/// also as channel_credentials().
Result<std::shared_ptr<grpc::Channel>> make_channel(const std::string& address,
                                                    const std::optional<TlsFiles>& tls = std::nullopt);

/// Waits for `time` and lets the channel connect meanwhile: gRPC 1.51 continues connecting only while a thread waits
/// for the channel, a failed call does not wait, and TLS takes several rounds. Returns earlier once a connection is
/// made, and within 50 ms when `is_over` becomes true.
void wait_until_connected(grpc::Channel& channel, Duration time, const std::function<bool()>& is_over);

/// Returns DATA_LOSS: the peer sent something that is not a valid message.
grpc::Status unreadable();

/// Finishes a client's stream whose Read() returned false. `finish` is the stream's Finish(): it returns at once if the
/// peer has ended the call, but never if the peer sent an invalid message; in that case the call is cancelled after ten
/// seconds, and the result is unreadable().
grpc::Status finish_after_read(grpc::ClientContext& context, const std::function<grpc::Status()>& finish);

/// Requirements of a server for its clients.
struct ServerOptions {
  std::optional<TlsFiles> tls{};
  Admission admit{};  ///< With TLS: decides on every call.
  int message_limit_bytes = kMessageLimitBytes;
  int calls_per_connection = 0;  ///< Further calls wait at the peer. 0: no limit.
};

/// A listening server. Destroy or stop() it before its services. Thread-safe.
class WireServer {
 public:
  /// Starts serving on `address`; port 0 selects a free one, and an existing socket file is replaced. Borrows the
  /// services until stop(). Errors: kInvalidArgument as make_channel(); kBusy if the port is taken; with TLS, also as
  /// server_credentials().
  static Result<std::unique_ptr<WireServer>> start(const std::string& address,
                                                   const std::vector<grpc::Service*>& services,
                                                   const ServerOptions& options = {});
  ~WireServer();
  WireServer(const WireServer&) = delete;
  WireServer& operator=(const WireServer&) = delete;

  /// 0 for a socket in the file system.
  [[nodiscard]] int port() const { return port_; }
  /// Lets open calls end by themselves for at most `grace`, then cancels them. Blocks; may be called twice.
  void stop(Duration grace);

 private:
  WireServer(std::unique_ptr<grpc::Server> server, int port) : server_(std::move(server)), port_(port) {}
  std::unique_ptr<grpc::Server> server_;
  int port_;
};

}  // namespace cyclorama
