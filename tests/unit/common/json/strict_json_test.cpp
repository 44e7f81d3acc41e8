// SPDX-License-Identifier: Apache-2.0
#include "common/json/strict_json.h"

#include <gmock/gmock.h>

namespace cyclorama {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

/// Returns the error of a document that `read` reads, or nothing.
template <typename Read>
std::string mistake_in(const char* text, const Read& read) {
  const auto document = parse_document(text, "a.json", "write it again");
  if (!document) return document.error().message();
  StrictJson::Mistakes mistakes("write it again");
  StrictJson json(*document, &mistakes);
  read(&json);
  const Status status = mistakes.status("a.json");
  if (status) return "";
  EXPECT_EQ(status.error().code(), ErrorCode::kBadData);
  return status.error().message();
}

TEST(StrictJson, reads_a_valid_document) {
  EXPECT_EQ(mistake_in(R"({"size": 3, "share": 0.5, "is_on": true, "name": "a", "list": [1, 2.5], "more": {"x": 1}})",
                       [](StrictJson* json) {
                         EXPECT_EQ(json->integer("size", 0, 3), 3);
                         EXPECT_EQ(json->number("share", 0.0, 1.0), 0.5);
                         EXPECT_TRUE(json->flag("is_on"));
                         EXPECT_EQ(json->text("name"), "a");
                         EXPECT_THAT(json->numbers("list", 1, 2), ElementsAre(1.0, 2.5));
                         EXPECT_TRUE(json->has("more"));
                         EXPECT_FALSE(json->has("less"));
                         StrictJson more = json->at("more");
                         EXPECT_EQ(more.integer("x", 0, 9), 1);
                         more.refuse_other_keys();
                         json->refuse_other_keys();
                       }),
            "");
}

TEST(StrictJson, reports_another_version_before_the_keys_that_differ) {
  const auto read = [](StrictJson* json) {
    json->require_version(2);
    json->integer("new", 0, 9);
    json->refuse_other_keys();
  };
  EXPECT_EQ(mistake_in(R"({"version": 2, "new": 1})", read), "");
  EXPECT_EQ(mistake_in(R"({"version": 1, "old": 1})", read),
            "a.json: /version: is 1, and this program reads version 2; write it again");
  EXPECT_EQ(mistake_in(R"({"version": "2", "new": 1})", read),
            "a.json: /version: is \"2\", and this program reads version 2; write it again");
  EXPECT_EQ(mistake_in(R"({"new": 1})", read), "a.json: : 'version' is missing; write it again");
}

TEST(StrictJson, reports_the_first_mistake_with_its_position_and_remedy) {
  const auto read = [](StrictJson* json) {
    for (StrictJson one : json->list("list", 1, 2)) {
      one.integer("x", 0, 9);
      one.refuse_other_keys();
    }
    json->refuse_other_keys();
  };
  EXPECT_EQ(mistake_in(R"({"list": [{"x": 1}, {"x": 10}]})", read),
            "a.json: /list/1/x: is not a whole number from 0.000000 to 9.000000; write it again");
  EXPECT_EQ(mistake_in(R"({"list": [{"x": 1.5}]})", read),
            "a.json: /list/0/x: is not a whole number from 0.000000 to 9.000000; write it again");
  EXPECT_EQ(mistake_in(R"({"list": [{}, {"x": "y"}]})", read), "a.json: /list/0: 'x' is missing; write it again");
  EXPECT_EQ(mistake_in(R"({"list": []})", read), "a.json: /list: is not a list of 1 to 2; write it again");
  EXPECT_EQ(mistake_in(R"({"list": [{"x": 1, "y": 2}]})", read),
            "a.json: /list/0: has a key that is not known, 'y'; remove it");
  EXPECT_EQ(mistake_in("[]", read), "a.json: : 'list' is missing; write it again");
}

TEST(StrictJson, refuses_other_kinds_of_values) {
  EXPECT_THAT(mistake_in(R"({"a": 1})", [](StrictJson* json) { EXPECT_EQ(json->text("a"), ""); }),
              HasSubstr("/a: is not a text, or too long"));
  EXPECT_THAT(mistake_in(R"({"a": "long"})", [](StrictJson* json) { json->text("a", 3); }), HasSubstr("too long"));
  EXPECT_THAT(mistake_in(R"({"a": 1})", [](StrictJson* json) { EXPECT_FALSE(json->flag("a")); }),
              HasSubstr("is not true or false"));
  EXPECT_THAT(mistake_in(R"({"a": 1e999})", [](StrictJson*) {}), HasSubstr("write it again"));
  EXPECT_THAT(mistake_in(R"({"a": null})", [](StrictJson* json) { EXPECT_EQ(json->number("a", 2.0, 3.0), 2.0); }),
              HasSubstr("is not a number from 2"));
}

TEST(StrictJson, names_the_position_of_invalid_json) {
  EXPECT_EQ(mistake_in("{\"a\": }", [](StrictJson*) {}), "a.json: byte 7: no JSON; write it again");
}

}  // namespace
}  // namespace cyclorama
