// SPDX-License-Identifier: Apache-2.0
#include "kiosk/tour/plan/svx_import.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <numbers>

#include "kiosk/tour/plan/tour_plan_text.h"

namespace cyclorama::tour {
namespace {

using testing::Contains;
using testing::HasSubstr;

/// A document of Voyager's schema: two tours, snapshots of the camera and of a model, annotations with and without
/// view.
constexpr const char* kDocument = R"({
  "asset": {"type": "application/si-dpo-3d.document+json", "version": "1.0"},
  "scene": 0,
  "scenes": [{"units": "cm", "nodes": [0], "setup": 0}],
  "nodes": [{"name": "Statue", "model": 0}],
  "models": [{"units": "cm", "derivatives": [], "annotations": [
    {"id": "a1", "title": "The crack", "lead": "From 1920.", "viewId": "s2", "articleId": "x"},
    {"id": "a2", "title": "The foot", "position": [0, 1, 2]}]}],
  "setups": [{
    "tours": [
      {"id": "t", "title": "Highlights", "titles": {"EN": "Highlights", "DE": "Das Beste"}, "lead": "All of it", "steps": [
        {"id": "s1", "title": "Front", "titles": {"EN": "Front", "DE": "Vorne"}},
        {"id": "s2", "title": "Right"},
        {"id": "gone", "title": "Lost"}]},
      {"title": "Details", "steps": []}],
    "snapshots": {
      "features": ["navigation", "models"],
      "targets": ["scenes/0/setup/navigation/orbit", "scenes/0/setup/navigation/offset", "model/0/rotation"],
      "states": [
        {"id": "s1", "curve": "EaseQuad", "duration": 2, "threshold": 0.5, "values": [[0, 0, 0], [10, 5, 300], [0, 0, 0]]},
        {"id": "s2", "values": [[-30, 90, 0], [0, 0, 200], [0, 0, 0]]}]}
  }]
})";

TEST(SvxImport, makes_stops_of_steps_and_of_annotations_with_a_view) {
  const auto import = import_svx(kDocument, "relic.svx.json");
  ASSERT_TRUE(import) << import.error().message();
  const TourPlan& plan = import->plan;
  EXPECT_EQ(plan.title.at("de"), "Das Beste");
  ASSERT_EQ(plan.stops.size(), 3u);
  EXPECT_EQ(plan.stops[0].title.at("en"), "Front");
  EXPECT_EQ(plan.stops[0].title.at("de"), "Vorne");
  EXPECT_NEAR(plan.stops[0].stop.position_m.x(), 0.1, 1e-9);
  EXPECT_NEAR(plan.stops[0].stop.position_m.y(), 3.0, 1e-9);
  EXPECT_NEAR(plan.stops[0].stop.heading_rad, 0.0, 1e-9);
  // From the right of the document's origin, 30 degrees down, towards -x.
  EXPECT_NEAR(plan.stops[1].stop.position_m.x(), 2.0 * std::cos(std::numbers::pi / 6), 1e-9);
  EXPECT_NEAR(plan.stops[1].stop.position_m.y(), 0.0, 1e-9);
  EXPECT_NEAR(plan.stops[1].stop.heading_rad, -std::numbers::pi / 2, 1e-9);
  EXPECT_EQ(plan.stops[2].text.at("en"), "From 1920.");
  const auto again = parse_tour_plan(to_toml(plan), "tour.toml");
  EXPECT_TRUE(again) << again.error().message();
}

TEST(SvxImport, lists_what_it_leaves_out) {
  const auto import = import_svx(kDocument, "relic.svx.json");
  ASSERT_TRUE(import);
  for (const char* const what : {"tour 2 ('Details')", "'model/0/rotation'", "the tour's 'lead'", "the step 'Lost'",
                                 "the pitch of -30", "the annotation 'The foot'", "'articleId' of the annotation"}) {
    EXPECT_THAT(import->left_out, Contains(HasSubstr(what)));
  }
}

TEST(SvxImport, refuses_other_documents_with_their_place) {
  const auto says = [](const std::string& text, std::size_t tour = 0) {
    const auto import = import_svx(text, "a.svx.json", tour);
    return import ? "" : import.error().message();
  };
  EXPECT_THAT(says("{"), HasSubstr("a.svx.json"));
  EXPECT_THAT(says("{}"), HasSubstr("has 0 tours"));
  EXPECT_THAT(says(R"({"setups": [{"tours": [{"title": "Empty"}]}]})"), HasSubstr("no step"));
  EXPECT_THAT(says(kDocument, 2), HasSubstr("has 2 tours"));
  EXPECT_THAT(says(R"({"scenes": [{"units": "ells"}], "setups": []})"), HasSubstr("a.svx.json"));
  EXPECT_NE(says(R"({"setups": [{"tours": [{"steps": [{"id": "s"}]}], "snapshots": {"targets": ["n/orbit", "n/offset"],
                   "states": [{"id": "s", "values": [[0, "x", 0], [0, 0, 1]]}]}}]})"),
            "");
}

}  // namespace
}  // namespace cyclorama::tour
