// SPDX-License-Identifier: Apache-2.0
/// crl.pem, and the owner's name in a certificate.
#include <cstddef>
#include <cstdint>
#include <string_view>

#include "common/wire/identity.h"
#include "renderfarm/trust/revocations.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace cyclorama;
  // An authority's certificate and its revocation list.
  const std::string_view text(reinterpret_cast<const char*>(data), size);
  const std::size_t cut = text.find("-----BEGIN X509 CRL");
  const std::string_view certificate = text.substr(0, cut);
  static_cast<void>(identity_in(certificate));
  static_cast<void>(trust::Revocations::parse(cut == std::string_view::npos ? "" : text.substr(cut), certificate));
  return 0;
}
