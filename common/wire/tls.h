// SPDX-License-Identifier: Apache-2.0
/// TLS 1.3 with certificates on both sides.
#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>

#include "common/base/result.h"
#include "common/wire/identity.h"

namespace grpc {
class ChannelCredentials;
class ServerCredentials;
}  // namespace grpc

namespace cyclorama {

/// PEM files, as made by cyclorama-authority. They are read again every few seconds: a renewed certificate is used for
/// the next connection, without a restart. A certificate and its key must be replaced together.
struct TlsFiles {
  std::filesystem::path authority{};    ///< Certificate of the trusted authority.
  std::filesystem::path certificate{};  ///< This process's own certificate.
  std::filesystem::path key{};          ///< This process's private key; readable only by its user.

  bool operator==(const TlsFiles&) const = default;
};

/// Decides whether to admit a call, by its peer. Returns nothing to admit it, else the reason as a sentence, which the
/// peer receives with PERMISSION_DENIED. Called on gRPC's threads, concurrently; must not wait.
using Admission = std::function<std::optional<std::string>(const Identity& who)>;

/// Checks that the files are usable now: they exist, belong together, and have not expired. Returns the certificate's
/// identity. Errors: kNotFound or kSystem if a file cannot be read; kBadData if a file is invalid, with file and
/// reason.
Result<Identity> check(const TlsFiles& files);

/// Returns credentials for a client. Errors, also of server_credentials(): those of check(); kSystem if this OpenSSL
/// cannot be restricted to TLS 1.3. From the first call of either function on, the whole process uses TLS 1.3 only.
/// Thread-safe.
/// The server's certificate must contain the address that is used to connect: a host name among its DNS names, an
/// address among its IP addresses.
Result<std::shared_ptr<grpc::ChannelCredentials>> channel_credentials(const TlsFiles& files);
/// Returns credentials for a server. They refuse every call of a peer without a certificate of the authority, then
/// every call that `admit` refuses; if `admit` is null, no others. Errors: kInvalidArgument if the certificate is not a
/// coordinator's.
Result<std::shared_ptr<grpc::ServerCredentials>> server_credentials(const TlsFiles& files, Admission admit);

}  // namespace cyclorama
