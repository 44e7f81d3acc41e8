// SPDX-License-Identifier: Apache-2.0
/// Identity of a call's peer, from its certificate.
#pragma once

#include <string>
#include <string_view>

#include "common/base/result.h"

namespace grpc {
class AuthContext;
class ServerContextBase;
}  // namespace grpc

namespace cyclorama {

/// Role of a certificate's owner in the farm, from its organizational unit (OU): "coordinator", "museum" or "node".
enum class Role {
  kNobody,  ///< Without TLS.
  kCoordinator,
  kMuseum,
  kNode,
};

/// Identity of a peer. Without TLS only the address is known. A value.
struct Identity {
  Role role = Role::kNobody;
  std::string name{};     ///< Common name of the certificate.
  std::string serial{};   ///< Serial number of the certificate, in upper-case hexadecimal.
  std::string address{};  ///< In gRPC's form: "ipv6:[::1]:40112".

  bool operator==(const Identity&) const = default;
};

/// Returns "museum", "nobody" and so on; with an identity, a text for a log: "the museum 'hall-3' (serial 4C97...)".
[[nodiscard]] std::string_view to_text(Role role);
[[nodiscard]] std::string to_text(const Identity& who);

/// Reads the first certificate of a PEM text; the address stays empty. Errors: kBadData if there is none, or if it does
/// not have exactly one common name and one known unit.
Result<Identity> identity_in(std::string_view certificate_pem);

/// Returns the identity of a call's peer. kNobody if the channel has no TLS, or the certificate states no role.
[[nodiscard]] Identity identity_of(const grpc::ServerContextBase& context);
[[nodiscard]] Identity identity_of(const grpc::AuthContext& context);

}  // namespace cyclorama
