// SPDX-License-Identifier: Apache-2.0
/// A site.toml: accepted network settings are the same after they were written, and every line of the files that are
/// made of them is a section, a comment or KEY=VALUE.
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

#include "common/base/check.h"
#include "common/network/network_settings.h"
#include "kiosk/network/network_files.h"

namespace {

void check_lines(const std::string& text) {
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t end = text.find('\n', at);
    CHECK(end != std::string::npos);
    const std::string_view line = std::string_view(text).substr(at, end - at);
    CHECK(line.starts_with('[') || line.starts_with('#') || line.find('=') != std::string_view::npos);
    for (const char c : line) CHECK(c >= ' ');
    at = end + 1;
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view text(reinterpret_cast<const char*>(data), size);
  const auto network = cyclorama::parse_network_settings(text, "site.toml");
  if (!network) return 0;
  const auto again = cyclorama::parse_network_settings(cyclorama::network_toml(*network), "site.toml");
  CHECK(again && *again == *network);
  cyclorama::NetworkSettings without_files = *network;
  without_files.login = {};
  const auto files = cyclorama::network::network_files(without_files, {});
  CHECK(files);
  for (const auto& file : *files) check_lines(file.content);
  return 0;
}
