// SPDX-License-Identifier: Apache-2.0
#include "appliance/scan/remote_pattern_screen.h"

#include <gmock/gmock.h>

#include <atomic>
#include <map>
#include <mutex>

#include "common/image/png.h"
#include "common/wire/calibration.grpc.pb.h"
#include "common/wire/channel.h"

namespace cyclorama::scan {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

/// A display that shows the requested patterns until a test makes it fail.
class FakePatternDisplay final : public wire::PatternScreen::Service {
 public:
  grpc::Status ShowPatterns(grpc::ServerContext*,
                            grpc::ServerReaderWriter<wire::PatternShown, wire::PatternRequest>* stream) override {
    if (is_taken) return {grpc::StatusCode::FAILED_PRECONDITION, "another calibration shows its patterns"};
    wire::PatternRequest order;
    while (stream->Read(&order)) {
      if (is_away) return {grpc::StatusCode::UNAVAILABLE, "head HDMI-A-1 is away; plug it in"};
      const std::lock_guard lock(mutex);
      for (const auto& head : order.heads()) shown[head.projector()] = head.png();
      wire::PatternShown answer;
      answer.set_number(order.number());
      stream->Write(answer);
    }
    is_back = true;
    return grpc::Status::OK;
  }
  std::atomic<bool> is_taken = false;
  std::atomic<bool> is_away = false;
  std::atomic<bool> is_back = false;
  std::mutex mutex;
  std::map<std::string, std::string> shown;
};

struct Display {
  FakePatternDisplay service;
  std::unique_ptr<WireServer> server = *WireServer::start("[::1]:0", {&service});
  [[nodiscard]] std::string address() const { return "[::1]:" + std::to_string(server->port()); }
};

std::vector<InstalledProjector> projectors() {
  InstalledProjector left;
  left.name = "left";
  left.lens = Pinhole::from_field_of_view(32, 20, 1.0);
  InstalledProjector right = left;
  right.name = "right";
  return {left, right};
}

constexpr std::chrono::milliseconds kSettle(1);

TEST(RemotePatternScreen, shows_on_the_right_display_and_releases_all_at_the_end) {
  Display a;
  Display b;
  {
    auto screen = RemotePatternScreen::open(
        projectors(), {*parse_pattern_display("left=" + a.address()), *parse_pattern_display("right=" + b.address())},
        kSettle);
    ASSERT_TRUE(screen.has_value()) << screen.error().message();
    EXPECT_EQ(a.service.shown.count("left"), 1u) << "dark at first";
    RgbImage picture(32, 20, 77);
    ASSERT_TRUE((*screen)->show(1, picture).has_value());
    EXPECT_EQ(a.service.shown.count("right"), 0u);
    const std::string png = b.service.shown["right"];
    const auto back = decode_png({reinterpret_cast<const std::byte*>(png.data()), png.size()}, 10000);
    ASSERT_TRUE(back.has_value());
    EXPECT_EQ(back->at(31, 19)[1], 77);
    ASSERT_TRUE((*screen)->show(1, RgbImage()).has_value());
    EXPECT_EQ(b.service.shown["right"], "");
    EXPECT_EQ((*screen)->show(2, picture).error().code(), ErrorCode::kInvalidArgument);
    EXPECT_EQ((*screen)->show(0, RgbImage(31, 20)).error().code(), ErrorCode::kInvalidArgument);
  }
  EXPECT_TRUE(a.service.is_back);
  EXPECT_TRUE(b.service.is_back);
}

TEST(RemotePatternScreen, passes_on_the_displays_refusal) {
  Display display;
  display.service.is_taken = true;
  const auto taken = RemotePatternScreen::open(projectors(), {*parse_pattern_display(display.address())}, kSettle);
  ASSERT_FALSE(taken.has_value());
  EXPECT_EQ(taken.error().code(), ErrorCode::kBusy);
  EXPECT_THAT(taken.error().message(), HasSubstr("another calibration"));
  display.service.is_taken = false;
  const auto screen = RemotePatternScreen::open(projectors(), {*parse_pattern_display(display.address())}, kSettle);
  ASSERT_TRUE(screen.has_value()) << screen.error().message();
  display.service.is_away = true;
  for (int i = 0; i < 2; ++i) {  // The head stays away, and each call reports it.
    const auto shown = (*screen)->show(0, RgbImage());
    ASSERT_FALSE(shown.has_value());
    EXPECT_EQ(shown.error().code(), ErrorCode::kUnavailable);
    EXPECT_THAT(shown.error().message(), HasSubstr("HDMI-A-1"));
  }
}

TEST(RemotePatternScreen, assigns_every_projector_to_one_display) {
  const auto none = RemotePatternScreen::open(projectors(), {*parse_pattern_display("left=[::1]:1")}, kSettle);
  ASSERT_FALSE(none.has_value());
  EXPECT_THAT(none.error().message(), HasSubstr("'right'"));
  const auto two = RemotePatternScreen::open(
      projectors(), {*parse_pattern_display("[::1]:1"), *parse_pattern_display("[::1]:2")}, kSettle);
  ASSERT_FALSE(two.has_value());
  EXPECT_EQ(two.error().code(), ErrorCode::kInvalidArgument);
}

TEST(RemotePatternScreen, reads_a_display_from_a_line_of_text) {
  EXPECT_THAT(parse_pattern_display("left,far right=[::1]:7404")->projectors, ElementsAre("left", "far right"));
  EXPECT_EQ(parse_pattern_display("left,right=museum:7404")->address, "museum:7404");
  EXPECT_TRUE(parse_pattern_display("[::1]:7404")->projectors.empty());
  for (const char* bad : {"", "left=", "=[::1]:7404", "left,,right=[::1]:1", "nonsense"}) {
    EXPECT_FALSE(parse_pattern_display(bad).has_value()) << bad;
  }
}

}  // namespace
}  // namespace cyclorama::scan
