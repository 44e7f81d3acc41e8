// SPDX-License-Identifier: Apache-2.0
#include "common/reach/page_reach.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace cyclorama {
namespace {

using testing::HasSubstr;

PageReach example() {
  PageReach reach;
  reach.name = "Hall „3“";
  reach.version = "0.1.0";
  reach.language = "de";
  reach.addresses = {"https://192.0.2.7:8443/", "https://[2001:db8::7]:8443/"};
  reach.fingerprint = "4F:A1:00";
  reach.wall_code = "0123456789abcdef";
  reach.has_pin = true;
  reach.answered_at = TimePoint(std::chrono::seconds(86400));
  return reach;
}

TEST(PageReach, survives_its_file) {
  const auto read = parse_page_reach(to_json(example()), "reach.json");
  ASSERT_TRUE(read) << read.error().message();
  EXPECT_EQ(*read, example());
  EXPECT_EQ(*parse_page_reach(to_json(PageReach{}), "reach.json"), PageReach{});
}

TEST(PageReach, makes_a_link_whose_secrets_are_not_sent_to_a_server) {
  PageReach reach = example();
  EXPECT_EQ(link_of(reach), "https://192.0.2.7:8443/login.html#sha256=4FA100&wall=0123456789abcdef");
  reach.wall_code.clear();
  EXPECT_EQ(link_of(reach), "https://192.0.2.7:8443/login.html#sha256=4FA100");
  reach.fingerprint.clear();
  EXPECT_EQ(link_of(reach), "https://192.0.2.7:8443/");
  reach.addresses.clear();
  EXPECT_EQ(link_of(reach), "");
}

TEST(PageReach, names_place_and_remedy_of_a_mistake) {
  const std::string good = to_json(example());
  for (const auto& [from, to] :
       std::vector<std::pair<std::string, std::string>>{{"\"version\": 1", "\"version\": 2"},
                                                        {"\"has_pin\": true", "\"has_pin\": 1"},
                                                        {"\"name\"", "\"nmae\""},
                                                        {"86400.0", "-1.0"},
                                                        {"{", ""}}) {
    std::string bad = good;
    ASSERT_NE(bad.find(from), std::string::npos) << from;
    bad.replace(bad.find(from), from.size(), to);
    const auto read = parse_page_reach(bad, "reach.json");
    ASSERT_FALSE(read) << to;
    EXPECT_EQ(read.error().code(), ErrorCode::kBadData);
    EXPECT_THAT(read.error().message(), HasSubstr("reach.json"));
    EXPECT_THAT(read.error().message(), HasSubstr("restart cyclorama-operator"));
  }
}

}  // namespace
}  // namespace cyclorama
