// SPDX-License-Identifier: Apache-2.0
// The first byte selects the format; an accepted mesh must be drawable and survive a round trip.
#include <cstddef>
#include <cstdint>
#include <string_view>

#include "appliance/interchange/mesh_files.h"
#include "common/base/check.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace cyclorama;
  if (size == 0) return 0;
  const std::string_view text(reinterpret_cast<const char*>(data) + 1, size - 1);
  const auto parse = [&]() -> Result<interchange::WarpNet> {
    switch (data[0] % 4) {
      case 0:
        return interchange::parse_bourke(text, 1.6);
      case 1:
        return interchange::parse_warp_obj(text);
      case 2:
        return interchange::parse_domeprojection(text);
      default:
        return interchange::parse_simcad(text);
    }
  };
  const auto net = parse();
  if (!net) return 0;
  CHECK(interchange::check(*net).has_value());
  if (net->columns > 0) {
    const auto printed = interchange::print_bourke(*net, 1.6);
    CHECK(printed.has_value() && interchange::parse_bourke(*printed, 1.6).has_value());
  }
  if (net->nodes.size() < 4096) {
    const auto region = interchange::region_from(*net, "r", 16, 9);
    if (region) CHECK(interchange::check(*region, interchange::WarpProfile::k2d).has_value());
  }
  return 0;
}
