// SPDX-License-Identifier: Apache-2.0
#include "common/geometry/obj_text.h"

#include <gtest/gtest.h>

#include <string>

namespace cyclorama {
namespace {

TEST(ObjCorner, indices_may_be_omitted) {
  const auto joined = [](std::string_view word) {
    const ObjCornerWords words = obj_corner(word);
    return std::string(words.vertex) + "|" + std::string(words.texture) + "|" + std::string(words.normal) + "|" +
           std::string(words.beyond);
  };
  EXPECT_EQ(joined("7"), "7|||");
  EXPECT_EQ(joined("7/-1"), "7|-1||");
  EXPECT_EQ(joined("7//3"), "7||3|");
  EXPECT_EQ(joined("7/-1/3"), "7|-1|3|");
  EXPECT_EQ(joined("1/2/3/4/5"), "1|2|3|4/5");
  EXPECT_EQ(joined(""), "|||");
  EXPECT_EQ(joined("/"), "|||");
}

TEST(ObjIndex, counts_from_one_or_backwards_from_the_last_vertex) {
  EXPECT_EQ(obj_index("1", 3, 5), 0u);
  EXPECT_EQ(obj_index("5", 3, 5), 4u);
  EXPECT_EQ(obj_index("-1", 3, 5), 2u);
  EXPECT_EQ(obj_index("-3", 3, 5), 0u);
  for (const char* const wrong : {"0", "6", "-4", "", "one", "1.5", "1 2", "-9223372036854775808", "9223372036854775807",
                                  "99999999999999999999"}) {
    EXPECT_EQ(obj_index(wrong, 3, 5), std::nullopt) << wrong;
  }
}

}  // namespace
}  // namespace cyclorama
