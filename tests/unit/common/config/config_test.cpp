// SPDX-License-Identifier: Apache-2.0
#include "common/config/config.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <functional>

namespace cyclorama {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::StartsWith;

/// Returns finish()'s message after `read` has requested its keys; empty if there is no mistake.
std::string complaint(const std::string& text, const std::function<void(ConfigTable&)>& read) {
  auto config = Config::parse(text, "site.toml");
  if (!config) return config.error().message();
  ConfigTable root = config->root();
  read(root);
  const Status status = config->finish();
  if (status) return "";
  EXPECT_EQ(status.error().code(), ErrorCode::kBadData);
  return status.error().message();
}

void read_wall(ConfigTable& root) {
  ConfigTable wall = root.table("wall");
  wall.number("radius_m", {0.5, 50.0});
  wall.number("arc_deg", {2.0, 360.0}, 180.0);
}

TEST(Config, reads_the_values_of_a_valid_file) {
  auto config = Config::parse(R"(
name = "grotto"
count = 3
on = true
list = [1, 2.5]
names = ["a", "b"]
walk = [[0, 1], [2, 3]]
[wall]
radius_m = 2.5
[[lamp]]
power = 1
[[lamp]]
power = 2
)",
                              "site.toml");
  ASSERT_TRUE(config.has_value());
  ConfigTable root = config->root();
  EXPECT_EQ(root.text("name"), "grotto");
  EXPECT_EQ(root.integer("count", {0, 9}), 3);
  EXPECT_TRUE(root.flag("on"));
  EXPECT_EQ(root.numbers("list", 2, {0, 9}), (std::vector<double>{1.0, 2.5}));
  EXPECT_EQ(root.texts("names"), (std::vector<std::string>{"a", "b"}));
  EXPECT_EQ(root.points("walk", 2, {0, 9}), (std::vector<std::vector<double>>{{0, 1}, {2, 3}}));
  EXPECT_EQ(root.table("wall").number("radius_m", {0.5, 50.0}), 2.5);
  std::vector<ConfigTable> lamps = root.tables("lamp");
  ASSERT_EQ(lamps.size(), 2u);
  EXPECT_EQ(lamps[0].number("power", {0, 9}), 1.0);
  EXPECT_EQ(lamps[1].number("power", {0, 9}), 2.0);
  EXPECT_TRUE(config->finish().has_value());
}

TEST(Config, absent_keys_have_their_defaults) {
  EXPECT_EQ(complaint("",
                      [](ConfigTable& root) {
                        EXPECT_EQ(root.number("a", {0, 1}, 0.5), 0.5);
                        EXPECT_EQ(root.integer("b", {0, 9}, 7), 7);
                        EXPECT_EQ(root.text("c", "x"), "x");
                        EXPECT_EQ(root.choice("d", {"p", "q"}, "q"), "q");
                        EXPECT_TRUE(root.flag("e", true));
                        EXPECT_EQ(root.numbers("f", 1, {0, 9}, std::vector<double>{4.0}), std::vector<double>{4.0});
                        EXPECT_TRUE(root.tables("g").empty());
                        EXPECT_TRUE(root.points("h", 2, {0, 9}).empty());
                      }),
            "");
}

TEST(Config, a_wrong_key_names_its_line_and_the_likely_key) {
  EXPECT_THAT(complaint("[wall]\nradius_m = 2\narc_dge = 90\n", read_wall),
              AllOf(StartsWith("site.toml:3: "), HasSubstr("wall.arc_dge"), HasSubstr("'arc_deg'")));
  EXPECT_THAT(complaint("[wall]\nradius_m = 2\nhumidity = 90\n", read_wall),
              AllOf(StartsWith("site.toml:3: "), HasSubstr("is not a setting")));
  EXPECT_THAT(complaint("[wall]\nradius_m = 2\n[well]\ndepth = 2\n", read_wall),
              AllOf(StartsWith("site.toml:3: "), HasSubstr("did you mean 'wall'")));
}

TEST(Config, a_wrong_unit_names_the_right_one) {
  EXPECT_THAT(complaint("[wall]\nradius_m = 2\narc_rad = 3.1\n", read_wall),
              AllOf(StartsWith("site.toml:3: "), HasSubstr("write 'arc_deg', in that unit")));
}

TEST(Config, a_misspelt_required_key_is_reported_once_at_its_line) {
  EXPECT_EQ(complaint("[wall]\n\nradus_m = 2\n", read_wall),
            "site.toml:3: wall.radus_m: is not a setting; did you mean 'radius_m'?");
  EXPECT_EQ(complaint("[wall]\n\nradius_mm = 2000\n", read_wall),
            "site.toml:3: wall.radius_mm: is not a setting; write 'radius_m', in that unit");
}

TEST(Config, a_missing_key_names_its_table) {
  EXPECT_THAT(complaint("name = 'x'\n[wall]\narc_deg = 90\n",
                        [](ConfigTable& root) {
                          root.text("name");
                          read_wall(root);
                        }),
              AllOf(StartsWith("site.toml:2: "), HasSubstr("wall.radius_m: is missing")));
}

TEST(Config, a_value_out_of_range_or_not_a_number_is_a_mistake_with_its_line) {
  for (const char* const value : {"-1", "51", "nan", "inf", "-inf", "'2'", "true", "[2]"}) {
    EXPECT_THAT(complaint(std::string("[wall]\n\nradius_m = ") + value, read_wall),
                AllOf(StartsWith("site.toml:3: wall.radius_m: "), HasSubstr("must be")))
        << value;
  }
}

TEST(Config, every_kind_of_value_refuses_the_others) {
  struct Case {
    const char* text;
    std::function<void(ConfigTable&)> read;
  };
  const Case cases[] = {
      {"x = 1.5",
       [](ConfigTable& r) {
         r.integer("x", {0, 9});
       }},
      {"x = 10",
       [](ConfigTable& r) {
         r.integer("x", {0, 9});
       }},
      {"x = 1", [](ConfigTable& r) { r.text("x"); }},
      {"x = 1", [](ConfigTable& r) { r.flag("x"); }},
      {"x = 'z'",
       [](ConfigTable& r) {
         r.choice("x", {"a", "b"});
       }},
      {"x = 1",
       [](ConfigTable& r) {
         r.choice("x", {"a", "b"});
       }},
      {"x = [1]",
       [](ConfigTable& r) {
         r.numbers("x", 2, {0, 9});
       }},
      {"x = ['a', 2]",
       [](ConfigTable& r) {
         r.numbers("x", 2, {0, 9});
       }},
      {"x = [1, 10]",
       [](ConfigTable& r) {
         r.numbers("x", 2, {0, 9});
       }},
      {"x = [1, 2]",
       [](ConfigTable& r) {
         r.points("x", 2, {0, 9});
       }},
      {"x = [[1, 2, 3]]",
       [](ConfigTable& r) {
         r.points("x", 2, {0, 9});
       }},
      {"x = ['a', 2]", [](ConfigTable& r) { r.texts("x"); }},
      {"x = 1", [](ConfigTable& r) { r.table("x"); }},
      {"x = 1", [](ConfigTable& r) { r.tables("x"); }},
      {"x = [1]", [](ConfigTable& r) { r.tables("x"); }},
  };
  for (const Case& c : cases) EXPECT_THAT(complaint(c.text, c.read), StartsWith("site.toml:1: x: ")) << c.text;
}

TEST(Config, the_first_mistake_is_reported_and_the_others_counted) {
  EXPECT_THAT(complaint("[wall]\nradius_m = 'a'\narc_deg = 'b'\nfoo = 1\n", read_wall),
              AllOf(StartsWith("site.toml:2: "), HasSubstr("(and 2 more)")));
}

TEST(Config, a_value_that_the_caller_refuses_is_reported_with_its_line) {
  EXPECT_THAT(complaint("[wall]\nradius_m = 2\n",
                        [](ConfigTable& root) {
                          ConfigTable wall = root.table("wall");
                          wall.number("radius_m", {0, 9});
                          wall.refuse("radius_m", "is too small for the door");
                        }),
              StartsWith("site.toml:2: wall.radius_m: is too small for the door"));
}

TEST(Config, a_setting_under_its_former_name_is_refused_with_the_new_one) {
  const auto read = [](ConfigTable& root) {
    root.refuse_renamed("former_m", "max_m");
    root.number("max_m", {0, 9}, 1.0);
  };
  EXPECT_THAT(complaint("former_m = 2\n", read), StartsWith("site.toml:1: former_m: is called 'max_m' now; rename it"));
  EXPECT_EQ(complaint("max_m = 2\n", read), "");
}

TEST(Config, invalid_toml_names_line_and_column) {
  for (const char* const text : {"a = ", "a = 1\na = 2", "[x", "a = 1 b = 2", "[\n", "[\n]", "[[\n", "[.]", "a.\n=1",
                                 "a = 1 \u00e9", "\u00e9 = 1", "\u4e00", "a = \"\xff\""}) {
    const auto config = Config::parse(text, "site.toml");
    ASSERT_FALSE(config.has_value()) << text;
    EXPECT_EQ(config.error().code(), ErrorCode::kBadData);
    EXPECT_THAT(config.error().message(), AllOf(StartsWith("site.toml:"), HasSubstr("not TOML"))) << text;
  }
}

TEST(Config, a_missing_file_is_reported_as_not_found) {
  const auto config = Config::read("/nowhere/site.toml");
  ASSERT_FALSE(config.has_value());
  EXPECT_EQ(config.error().code(), ErrorCode::kNotFound);
}

}  // namespace
}  // namespace cyclorama
