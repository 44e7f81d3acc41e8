// SPDX-License-Identifier: Apache-2.0
#include <cstdint>
#include <cstdlib>
#include <string_view>

#include "kiosk/provision/folder_copy.h"
#include "kiosk/provision/operator_settings.h"
#include "kiosk/provision/owner_key.h"
#include "kiosk/provision/pin.h"
#include "kiosk/provision/provisioning_report.h"
#include "kiosk/provision/sandboxed_check.h"

/// A USB stick's files other than settings, and files read back from the disk: rejected, or unchanged by a round trip.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace cyclorama;
  if (size == 0) return 0;
  const std::string_view text(reinterpret_cast<const char*>(data + 1), size - 1);
  if (data[0] % 5 == 4) {
    const auto verdict = provision::parse_verdict(text);
    if (verdict && !provision::parse_verdict(provision::verdict_json(*verdict))) std::abort();
  } else if (data[0] % 5 == 3) {
    // A signature and a key, of which nobody can guess one that fits.
    const std::size_t half = text.size() / 2;
    if (provision::is_signed_by("settings", text.substr(0, half), text.substr(half))) std::abort();
  } else if (data[0] % 5 == 0) {
    const auto files = provision::parse_checksums(text);
    if (!files) return 0;
    for (const provision::CopiedFile& file : *files) {
      if (file.name.find("..") == 0 || file.name.front() == '/') std::abort();
    }
    const auto again = provision::parse_checksums(provision::checksums_text(*files));
    if (!again || again->size() != files->size()) std::abort();
  } else if (data[0] % 5 == 1) {
    const auto settings = provision::parse_operator_settings(text, "operator.toml");
    if (settings && settings->pin && !provision::check_pin(*settings->pin)) std::abort();
  } else {
    const auto report = provision::parse_report(text);
    if (!report) return 0;
    const auto again = provision::parse_report(provision::report_json(*report));
    if (!again) std::abort();
  }
  return 0;
}
