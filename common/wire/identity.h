// SPDX-License-Identifier: Apache-2.0
/// Who is at the other end of a call, as its certificate says.
#pragma once

#include <string>
#include <string_view>

#include "common/base/result.h"

namespace grpc {
class AuthContext;
class ServerContextBase;
}  // namespace grpc

namespace cyclorama {

/// What a certificate's owner is to the farm: its organizational unit (OU), "head", "museum" or "node".
enum class Role {
  kNobody,  ///< Without TLS.
  kHead,
  kMuseum,
  kNode,
};

/// A value. Without TLS only the address is known.
struct Identity {
  Role role = Role::kNobody;
  std::string name{};     ///< The certificate's common name.
  std::string serial{};   ///< Its serial number, in upper-case hexadecimal.
  std::string address{};  ///< As gRPC writes it: "ipv6:[::1]:40112".

  bool operator==(const Identity&) const = default;
};

/// "museum", "nobody"; and for a log: "the museum 'hall-3' (serial 4C97...)".
[[nodiscard]] std::string_view to_text(Role role);
[[nodiscard]] std::string to_text(const Identity& who);

/// What the first certificate of a PEM text says; the address stays empty.
/// kBadData  it is no certificate, or has not exactly one common name and one known unit.
Result<Identity> identity_in(std::string_view certificate_pem);

/// Of a call that a server received. Nobody's when the channel has no TLS, or its certificate says no role.
[[nodiscard]] Identity identity_of(const grpc::ServerContextBase& context);
[[nodiscard]] Identity identity_of(const grpc::AuthContext& context);

}  // namespace cyclorama
