// SPDX-License-Identifier: Apache-2.0
#include "kiosk/setup/setup_offer.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "common/room/installation.h"

namespace cyclorama::setup {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;

constexpr const char* kSite =
    "# Ours.\n[farm]\ncoordinators = [\"[::1]:7401\"]\n[hours]\nopen = [\"Mon-Sun 10:00-18:00\"]\n";

SetupFacts facts() {
  return {{{"HDMI-A-1", "EPS EB-L1755U", 1920, 1200}, {"HDMI-A-2", "", 1920, 1200}}, {"eno1"}, {"usb-0000:00:14.0-2"}};
}
using Steps = std::map<std::string, StepDraft>;

/// Returns the drafts of the steps as the page fills them in at first, with some changes.
Steps steps(const Fields& changes = {}, const char* step = "") {
  Steps all;
  for (const std::string& name : field_steps()) all[name].fields = first_fields(name, {{"site.toml", kSite}}, facts());
  all[kNameStep].fields["museum"] = "Hall 3";
  for (const char* const key :
       {"radius_m", "arc_deg", "bottom_m", "top_m", "eye_m", "lens_height_m", "lens_distance_m", "picture_width_m"}) {
    all[kWallStep].fields[key] = std::string(key) == "arc_deg" ? "120" : std::string(key) == "bottom_m" ? "0,5" : "2.9";
  }
  all[kFarmStep].fields["coordinators"] = "farm.example:7401";
  for (const auto& [field, value] : changes) all[step].fields[field] = value;
  return all;
}

std::vector<std::string> wrong_fields(const char* step, const Fields& changes) {
  std::vector<std::string> fields;
  for (const FieldProblem& problem : problems_of(step, steps(changes, step), facts())) fields.push_back(problem.field);
  return fields;
}

TEST(SetupFields, are_good_as_the_page_first_shows_them) {
  for (const std::string& step : field_steps()) EXPECT_THAT(wrong_fields(step.c_str(), {}), IsEmpty()) << step;
}

TEST(SetupFields, need_a_farm_where_the_image_names_this_computer) {
  Steps all;
  all[kFarmStep].fields = first_fields(kFarmStep, {{"site.toml", kSite}}, facts());
  EXPECT_EQ(problems_of(kFarmStep, all, facts()).size(), 1U);
  all[kFarmStep].revision = 1;
  EXPECT_THAT(problems_of(kFarmStep, all, facts()), IsEmpty()) << "somebody wants it so";
}

TEST(SetupFields, are_refused_one_by_one) {
  EXPECT_THAT(wrong_fields("name", {{"museum", ""}}), ElementsAre("museum"));
  EXPECT_THAT(wrong_fields("name", {{"museum", "a\"b"}}), ElementsAre("museum"));
  EXPECT_THAT(wrong_fields("network", {{"vlan", "x"}}), ElementsAre("vlan"));
  EXPECT_THAT(wrong_fields("network", {{"interface", "eno9"}}), ElementsAre("interface"));
  EXPECT_THAT(
      wrong_fields("network",
                   {{"interface", "eno1"}, {"ipv4", "static"}, {"ipv4_address", "192.0.2.7"}, {"dns", "192.0.2.1"}}),
      ElementsAre("ipv4_address"));
  EXPECT_THAT(wrong_fields("projectors", {{"count", "9"}}), ElementsAre("count"));
  EXPECT_THAT(wrong_fields("projectors", {{"2.name", "left"}}), ElementsAre("2.name"));
  EXPECT_THAT(wrong_fields("projectors", {{"2.connector", "HDMI-A-1"}}), ElementsAre("2.connector"));
  EXPECT_THAT(wrong_fields("projectors", {{"2.connector", "DP-9"}}), ElementsAre("2.connector"));
  EXPECT_THAT(wrong_fields("projectors", {{"1.turn_deg", "45"}}), ElementsAre("1.turn_deg"));
  EXPECT_THAT(wrong_fields("projectors", {{"1.pjlink", "a b"}}), ElementsAre("1.pjlink"));
  EXPECT_THAT(wrong_fields("wall", {{"radius_m", "nan"}}), ElementsAre("radius_m"));
  EXPECT_THAT(wrong_fields("wall", {{"top_m", "0.3"}}), ElementsAre("top_m"));
  EXPECT_THAT(wrong_fields("wall", {{"shape", "flat"}}), ElementsAre("width_m", "distance_m"));
  EXPECT_THAT(wrong_fields("cameras", {{"calibration", "usb-7"}}), ElementsAre("calibration"));
  EXPECT_THAT(wrong_fields("farm", {{"coordinators", "farm"}}), ElementsAre("coordinators"));
  EXPECT_THAT(wrong_fields("tour", {{"scene", "a\"b"}}), ElementsAre("scene"));
}

TEST(SetupOffer, changes_one_thing_and_keeps_the_rest_of_the_file) {
  const auto name = offer_of(kNameStep, steps(), facts(), {{"site.toml", kSite}}, {});
  ASSERT_TRUE(name) << name.error().message();
  EXPECT_EQ(name->at("site.toml"),
            "# Ours.\n[farm]\nmuseum = \"Hall 3\"\ncoordinators = [\"[::1]:7401\"]\n[hours]\n"
            "open = [\"Mon-Sun 10:00-18:00\"]\n");
  const auto network = offer_of(kNetworkStep, steps({{"interface", "eno1"}, {"vlan", "42"}}, kNetworkStep), facts(),
                                {{"site.toml", kSite}}, {});
  ASSERT_TRUE(network);
  EXPECT_EQ(network->at("site.toml"), std::string(kSite) + "\n[network]\ninterface = \"eno1\"\nvlan = 42\n");
  const auto again = offer_of(kNetworkStep, steps(), facts(), *network, {});
  EXPECT_THAT(again->at("site.toml"), Not(HasSubstr("network")));
}

TEST(SetupOffer, makes_a_room_of_projectors_and_wall) {
  const auto offer = offer_of(kWallStep, steps(), facts(), {}, {});
  ASSERT_TRUE(offer) << offer.error().message();
  const auto room = parse_installation(offer->at("installation.toml"), "installation.toml");
  ASSERT_TRUE(room) << room.error().message();
  EXPECT_EQ(room->projectors.at(1).plug.connector, "HDMI-A-2");
  EXPECT_EQ(room->projectors.at(0).lens.height_px, 1200);
}

TEST(SetupOffer, names_the_files_that_people_brought) {
  const SettingsFiles brought{{"tls/authority.crt", "a"}, {"tls/certificate.crt", "c"}, {"tls/key.pem", "k"}};
  const auto offer = offer_of(kFarmStep, steps({{"coordinators", "farm.example:7401; [2001:db8::1]:7401"}}, kFarmStep),
                              facts(), {{"site.toml", kSite}}, brought);
  ASSERT_TRUE(offer);
  EXPECT_THAT(offer->at("site.toml"), HasSubstr("coordinators = [\"farm.example:7401\", \"[2001:db8::1]:7401\"]"));
  EXPECT_THAT(offer->at("site.toml"), HasSubstr("key = \"tls/key.pem\""));
  EXPECT_EQ(offer->at("tls/key.pem"), "k");
  const auto camera = offer_of(kCamerasStep, steps(), facts(), {}, {{"camera.json", "{}"}});
  EXPECT_EQ(camera->at("calibrator.toml"),
            "[camera]\nlens = \"camera.json\"\nport = \"usb-0000:00:14.0-2\"\nkind = \"v4l2\"\n");
}

TEST(SetupOffer, is_not_made_of_a_step_with_a_mistake) {
  const auto offer = offer_of(kWallStep, steps({{"count", "0"}}, kProjectorsStep), facts(), {}, {});
  ASSERT_FALSE(offer);
  EXPECT_THAT(offer.error().message(), HasSubstr("Choose how many projectors"));
}

}  // namespace
}  // namespace cyclorama::setup
