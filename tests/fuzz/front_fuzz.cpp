// SPDX-License-Identifier: Apache-2.0
/// pareto_front.toml.
#include <cstddef>
#include <cstdint>

#include "common/base/check.h"
#include "renderfarm/governor/pareto_front_file.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace cyclorama;
  const auto front = governor::parse_pareto_front({reinterpret_cast<const char*>(data), size}, "pareto_front.toml");
  if (!front) return 0;
  const auto again = governor::parse_pareto_front(governor::pareto_front_text(*front, "again"), "again.toml");
  CHECK(again.has_value() && again->size() == front->size());
  for (std::size_t i = 0; i < front->size(); ++i) {
    CHECK(render::validate((*front)[i].quality).has_value());
    CHECK((*again)[i].quality == (*front)[i].quality && (*again)[i].cost == (*front)[i].cost);
  }
  return 0;
}
