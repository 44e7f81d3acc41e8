// SPDX-License-Identifier: Apache-2.0
#include "common/wire/identity.h"

#include <fmt/format.h>
#include <grpc/grpc_security_constants.h>
#include <grpcpp/security/auth_context.h>
#include <grpcpp/server_context.h>

#include <array>
#include <optional>
#include <utility>

#include "common/base/text.h"
#include "common/wire/openssl.h"

namespace cyclorama {
namespace {

constexpr std::array<std::pair<Role, std::string_view>, 4> kRoles{
    {{Role::kNobody, "nobody"}, {Role::kCoordinator, "coordinator"}, {Role::kMuseum, "museum"}, {Role::kNode, "node"}}};

/// Returns the subject's only entry of that kind; empty if there is none, or if there are several.
std::optional<std::string> entry(const X509_NAME* subject, int kind) {
  const int at = X509_NAME_get_index_by_NID(subject, kind, -1);
  if (at < 0 || X509_NAME_get_index_by_NID(subject, kind, at) >= 0) return std::nullopt;
  unsigned char* text = nullptr;
  const int bytes = ASN1_STRING_to_UTF8(&text, X509_NAME_ENTRY_get_data(X509_NAME_get_entry(subject, at)));
  if (bytes < 0) return std::nullopt;
  std::string copy(text, text + bytes);
  OPENSSL_free(text);
  return copy;
}

}  // namespace

std::string_view to_text(Role role) {
  for (const auto& [known, text] : kRoles) {
    if (known == role) return text;
  }
  return "?";
}

std::string to_text(const Identity& who) {
  if (who.role == Role::kNobody) return fmt::format("a peer without a certificate at {}", printable(who.address));
  return fmt::format("the {} '{}' (serial {})", to_text(who.role), who.name, who.serial);
}

Result<OpensslCertificate> parse_certificate(std::string_view pem) {
  OpensslCertificate certificate(PEM_read_bio_X509(bio_of(pem).get(), nullptr, nullptr, nullptr));
  if (certificate == nullptr) return Error(ErrorCode::kBadData, "is not a certificate in PEM form");
  return certificate;
}

std::string serial_text(const ASN1_INTEGER* serial) {
  const std::unique_ptr<BIGNUM, OpensslFree<BN_free>> number(ASN1_INTEGER_to_BN(serial, nullptr));
  char* const digits = number ? BN_bn2hex(number.get()) : nullptr;
  if (digits == nullptr) return "";
  std::string text(digits);
  OPENSSL_free(digits);
  return text;
}

std::string day_text(const ASN1_TIME* time) {
  std::tm parts{};
  if (time == nullptr || ASN1_TIME_to_tm(time, &parts) != 1) return "?";
  return fmt::format("{:04}-{:02}-{:02}", parts.tm_year + 1900, parts.tm_mon + 1, parts.tm_mday);
}

Result<Identity> identity_in_subject(const X509_NAME* subject) {
  const std::optional<std::string> name = entry(subject, NID_commonName);
  const std::optional<std::string> unit = entry(subject, NID_organizationalUnitName);
  Identity who;
  for (const auto& [role, text] : kRoles) {
    if (unit == text) who.role = role;
  }
  if (!name || name->empty() || printable(*name, 64) != *name || who.role == Role::kNobody) {
    return Error(ErrorCode::kBadData,
                 "does not identify its owner; it needs a common name, and the unit coordinator, museum or node");
  }
  who.name = *name;
  return who;
}

Result<Identity> identity_in(std::string_view certificate_pem) {
  TRY_ASSIGN(const OpensslCertificate certificate, parse_certificate(certificate_pem));
  TRY_ASSIGN(Identity who, identity_in_subject(X509_get_subject_name(certificate.get())));
  who.serial = serial_text(X509_get0_serialNumber(certificate.get()));
  return who;
}

Identity identity_of(const grpc::AuthContext& context) {
  const std::vector<grpc::string_ref> pem = context.FindPropertyValues(GRPC_X509_PEM_CERT_PROPERTY_NAME);
  if (pem.empty()) return {};
  Result<Identity> who = identity_in({pem.front().data(), pem.front().size()});
  return who ? *std::move(who) : Identity{};
}

Identity identity_of(const grpc::ServerContextBase& context) {
  const auto security = context.auth_context();
  Identity who = security ? identity_of(*security) : Identity{};
  who.address = context.peer();
  return who;
}

}  // namespace cyclorama
