// SPDX-License-Identifier: Apache-2.0
/// A museum's request for a certificate, and a certificate that may be its answer.
#include <cstddef>
#include <cstdint>
#include <string_view>

#include "common/wire/certificate_request.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace cyclorama;
  const std::string_view text(reinterpret_cast<const char*>(data), size);
  const std::size_t cut = text.find("-----BEGIN CERTIFICATE-----");
  const std::string_view request = text.substr(0, cut);
  const std::string_view certificate = cut == std::string_view::npos ? "" : text.substr(cut);
  static_cast<void>(identity_in_request(request));
  static_cast<void>(is_for_request(certificate, request));
  static_cast<void>(end_of_certificate(certificate));
  return 0;
}
