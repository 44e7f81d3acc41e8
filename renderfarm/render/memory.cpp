// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/render/memory.h"

#include <fmt/format.h>

#include <fstream>
#include <sstream>

#include "common/base/text.h"

namespace cyclorama {

std::optional<std::size_t> parse_available_memory(std::string_view meminfo) {
  constexpr std::string_view kField = "MemAvailable:";
  const std::size_t at = meminfo.find(kField);
  if (at == std::string_view::npos) return std::nullopt;
  std::string_view rest = meminfo.substr(at + kField.size());
  rest.remove_prefix(std::min(rest.find_first_not_of(' '), rest.size()));
  const auto kilobytes = parse_integer(rest.substr(0, rest.find_first_of(" \n")));
  if (!kilobytes || *kilobytes < 0) return std::nullopt;
  return static_cast<std::size_t>(*kilobytes) * 1024;
}

std::optional<std::size_t> available_memory() {
  // Not read_file(): files in /proc have no size.
  std::ifstream file("/proc/meminfo");
  std::ostringstream text;
  text << file.rdbuf();
  return parse_available_memory(text.str());
}

std::string describe_bytes(std::size_t bytes) {
  const double value = static_cast<double>(bytes);
  if (value >= 1e9) return fmt::format("{:.1f} GB", value / 1e9);
  if (value >= 1e6) return fmt::format("{:.1f} MB", value / 1e6);
  return fmt::format("{:.1f} kB", value / 1e3);
}

}  // namespace cyclorama
