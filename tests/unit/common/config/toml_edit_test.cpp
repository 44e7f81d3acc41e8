// SPDX-License-Identifier: Apache-2.0
#include "common/config/toml_edit.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace cyclorama {
namespace {

using testing::HasSubstr;

constexpr const char* kSite =
    "# Ours.\n"
    "[farm]\n"
    "coordinators = [\n  \"[::1]:7401\",  # the first\n]\n"
    "museum = \"Höhle \\\"3\\\"\" # its name\n"
    "\n"
    "[network]  # by the electrician\n"
    "vlan = 7\n"
    "[network.login]\n"
    "method = \"peap\"\n"
    "# Closed on Mondays.\n"
    "[hours]\n"
    "open = [\"Tue-Sun 10:00-18:00\"]\n";

std::string changed(const Result<std::string>& result) {
  EXPECT_TRUE(result) << result.error().message();
  return result ? *result : "";
}

TEST(TomlEdit, replaces_one_table_with_its_subtables_and_keeps_the_rest) {
  EXPECT_EQ(changed(with_table(kSite, "site.toml", "network", "[network]\nvlan = 8\n")),
            "# Ours.\n[farm]\ncoordinators = [\n  \"[::1]:7401\",  # the first\n]\n"
            "museum = \"Höhle \\\"3\\\"\" # its name\n\n# Closed on Mondays.\n[hours]\n"
            "open = [\"Tue-Sun 10:00-18:00\"]\n\n[network]\nvlan = 8\n");
  EXPECT_EQ(changed(with_table("[a]\nb = 1\n", "site.toml", "network", "[network]\nvlan = 8\n")),
            "[a]\nb = 1\n\n[network]\nvlan = 8\n");
  EXPECT_EQ(changed(with_table("[network]\nvlan = 7", "site.toml", "network", "")), "");
  EXPECT_EQ(changed(with_table("", "site.toml", "network", "[network]\n")), "[network]\n");
}

TEST(TomlEdit, replaces_arrays_of_tables_within_a_table) {
  EXPECT_EQ(changed(with_table("[watch]\na = 1\n[[watch.camera]]\nname = \"l\"\n[[watch.camera]]\n[z]\n", "c.toml",
                               "watch", "[watch]\na = 2\n")),
            "[z]\n\n[watch]\na = 2\n");
}

TEST(TomlEdit, sets_a_value_where_it_stands) {
  EXPECT_THAT(changed(with_value(kSite, "site.toml", "farm", "museum", "\"Hall 4\"")),
              HasSubstr("\nmuseum = \"Hall 4\" # its name\n"));
  EXPECT_THAT(changed(with_value(kSite, "site.toml", "farm", "coordinators", "[\"[::1]:1\"]")),
              HasSubstr("[farm]\ncoordinators = [\"[::1]:1\"]\nmuseum"));
  EXPECT_THAT(changed(with_value(kSite, "site.toml", "farm", "scene", "\"grotto\"")),
              HasSubstr("[farm]\nscene = \"grotto\"\ncoordinators"));
  EXPECT_EQ(changed(with_value("a = 1", "site.toml", "farm", "scene", "\"grotto\"")),
            "a = 1\n\n[farm]\nscene = \"grotto\"\n");
}

TEST(TomlEdit, refuses_what_it_cannot_change_for_certain) {
  for (const char* const text : {"network = { vlan = 7 }\n", "network = 1\n"}) {
    const auto result = with_table(text, "site.toml", "network", "[network]\nvlan = 8\n");
    ASSERT_FALSE(result) << text;
    EXPECT_THAT(result.error().message(), HasSubstr("site.toml: [network] is written in a way"));
  }
  const auto dotted =
      with_table("network.vlan = 7\n[network.login]\n", "site.toml", "network", "[network]\nvlan = 8\n");
  EXPECT_TRUE(!dotted || dotted->find("vlan = 7") == std::string::npos);
  EXPECT_FALSE(with_table("[a\n", "site.toml", "network", ""));
  EXPECT_FALSE(with_value("[a]\n", "site.toml", "a", "b", "no value"));
}

}  // namespace
}  // namespace cyclorama
