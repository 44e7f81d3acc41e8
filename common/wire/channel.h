// SPDX-License-Identifier: Apache-2.0
/// gRPC as this house uses it: addresses, limits, keep-alive, and errors that survive the crossing.
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

/// No message is larger: a whole 16k-wide frame's tile at full quality fits many times over.
inline constexpr int kMessageLimitBytes = 16 << 20;

/// ErrorCode and gRPC status, one to one; the message crosses unchanged.
[[nodiscard]] grpc::Status to_grpc(const Error& error);
/// Precondition: !status.ok(). `doing` is what this side was doing: "opening the visit".
[[nodiscard]] Error from_grpc(const grpc::Status& status, std::string_view doing);

/// A channel to "[::1]:7401" (or a name and port), or to a socket in the file system, "unix:/run/x.sock". It dials when
/// it is used, for at most 2 s, keeps alive every 5 s and dials again with a back-off of 0.1 to 2 s. Without `tls`
/// nothing is encrypted. Thread-safe once made. kInvalidArgument  as parse_address().     With `tls` also as
/// channel_credentials().
Result<std::shared_ptr<grpc::Channel>> make_channel(const std::string& address,
                                                    const std::optional<TlsFiles>& tls = std::nullopt);

/// Waits for `time` and lets the channel dial meanwhile: gRPC 1.51 gets on with a connection only while a thread waits
/// for the channel, a failed call does not wait, and TLS takes several turns. Returns sooner when a connection comes
/// about, and within 50 ms when `is_over` becomes true.
void wait_dialling(grpc::Channel& channel, Duration time, const std::function<bool()>& is_over);

/// DATA_LOSS: what the peer sent is no message.
grpc::Status unreadable();

/// The end of a client's stream whose Read() returned false. `finish` is the stream's Finish(): where the peer has
/// ended the call it returns at once; where the peer sent what is no message it never would, so the call is cancelled
/// after ten seconds, and this is unreadable().
grpc::Status finish_after_read(grpc::ClientContext& context, const std::function<grpc::Status()>& finish);

/// What a server asks of those who dial.
struct ServerOptions {
  std::optional<TlsFiles> tls{};
  Admission admit{};  ///< With TLS: decides on every call.
  int message_limit_bytes = kMessageLimitBytes;
  int calls_per_connection = 0;  ///< More wait at the peer. 0: no limit.
};

/// A listening server. Destroy or stop() it before its services. Thread-safe.
class WireServer {
 public:
  /// Starts to serve on `address`; port 0 takes a free one, and a socket's file that is there already is replaced. The
  /// services are borrowed until stop(). kInvalidArgument  as make_channel().     kBusy  the port is taken.     With
  /// TLS also as server_credentials().
  static Result<std::unique_ptr<WireServer>> start(const std::string& address,
                                                   const std::vector<grpc::Service*>& services,
                                                   const ServerOptions& options = {});
  ~WireServer();
  WireServer(const WireServer&) = delete;
  WireServer& operator=(const WireServer&) = delete;

  /// 0 for a socket in the file system.
  [[nodiscard]] int port() const { return port_; }
  /// Gives calls until `grace` has passed to end by themselves, then cancels them. Blocks; may be called twice.
  void stop(Duration grace);

 private:
  WireServer(std::unique_ptr<grpc::Server> server, int port) : server_(std::move(server)), port_(port) {}
  std::unique_ptr<grpc::Server> server_;
  int port_;
};

}  // namespace cyclorama
