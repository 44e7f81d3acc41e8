// SPDX-License-Identifier: Apache-2.0
/// TLS 1.3 with certificates on both sides: what a process shows, and whom it trusts.
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

/// PEM files, as cyclorama-authority makes them. They are read again every few seconds: a renewed certificate is used
/// for the next connection, without a restart. Replace the certificate and its key together.
struct TlsFiles {
  std::filesystem::path authority{};    ///< Whose certificates are believed.
  std::filesystem::path certificate{};  ///< This process's own.
  std::filesystem::path key{};          ///< Readable by its user alone.

  bool operator==(const TlsFiles&) const = default;
};

/// Decides on a call, by who calls: nothing for a welcome, else why not, in a sentence that the peer gets with
/// PERMISSION_DENIED. Called on gRPC's threads, many at a time; must not wait.
using Admission = std::function<std::optional<std::string>(const Identity& who)>;

/// That the files can work now: they are there, belong together, and have not run out. Returns whose they are.
/// kNotFound, kSystem  a file cannot be read.     kBadData  a file is not what it should be; says which, and why.
Result<Identity> check(const TlsFiles& files);

/// Both: errors as check(), and kSystem when this OpenSSL cannot be held to TLS 1.3. From the first call on, the whole
/// process speaks TLS 1.3 and nothing older. Thread-safe.
///
/// The server's certificate must name what was dialled: a host's name among its DNS names, an address among its IP
/// addresses.
Result<std::shared_ptr<grpc::ChannelCredentials>> channel_credentials(const TlsFiles& files);
/// Every call of a peer without a certificate of the authority is refused, then those that `admit` refuses (null:
/// none). kInvalidArgument  the certificate is not a head's.
Result<std::shared_ptr<grpc::ServerCredentials>> server_credentials(const TlsFiles& files, Admission admit);

}  // namespace cyclorama
