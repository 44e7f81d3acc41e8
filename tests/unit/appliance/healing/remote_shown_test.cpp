// SPDX-License-Identifier: Apache-2.0
#include "appliance/healing/remote_shown.h"

#include <gtest/gtest.h>

#include <mutex>

#include "common/image/jpeg.h"
#include "common/wire/channel.h"
#include "common/wire/show.grpc.pb.h"
#include "tests/doubles/fake_clock.h"

namespace cyclorama::healing {
namespace {

using namespace std::chrono_literals;

constexpr int kWidth = 32;
constexpr int kHeight = 16;

/// A display whose clock is ahead, and which draws slowly.
class FakeShownDisplay final : public wire::ShownPictures::Service {
 public:
  explicit FakeShownDisplay(FakeClock* clock) : clock_(*clock) {}
  grpc::Status GetShown(grpc::ServerContext*, const wire::ShownRequest* request, wire::ShownReply* reply) override {
    const std::lock_guard lock(mutex);
    reply->set_received_ns(to_nanoseconds(clock_.now() + ahead));
    reply->set_known_until_ns(to_nanoseconds(clock_.now() + ahead));
    for (std::size_t i = 0; i < shown.size(); ++i) {
      const bool is_over = i + 1 < shown.size() && to_nanoseconds(shown[i + 1].at + ahead) <= request->from_ns();
      if (is_over || to_nanoseconds(shown[i].at + ahead) > request->until_ns()) continue;
      wire::ShownMoment* const moment = reply->add_moments();
      moment->set_number(shown[i].number);
      moment->set_shown_ns(to_nanoseconds(shown[i].at + ahead));
      moment->set_is_show(true);
      if (shown[i].number <= request->known()) continue;
      clock_.advance(draws_for);
      const RgbImage picture(kWidth, kHeight, 90);
      auto jpeg = JpegEncoder().encode(picture, {95, false});
      if (!jpeg) return {grpc::StatusCode::INTERNAL, "no JPEG"};
      wire::ShownHead* const head = moment->add_heads();
      head->set_projector("left");
      head->set_jpeg(jpeg->data(), jpeg->size());
    }
    // The requested pictures become known a moment later.
    clock_.advance(draws_for);
    reply->set_answered_ns(to_nanoseconds(clock_.now() + ahead));
    return grpc::Status::OK;
  }
  struct Moment {
    std::uint64_t number;
    TimePoint at;
  };
  std::mutex mutex;
  std::vector<Moment> shown;
  Duration ahead = 1234567us;
  Duration draws_for = 30ms;

 private:
  FakeClock& clock_;
};

struct Room {
  FakeClock clock;
  FakeShownDisplay display{&clock};
  std::unique_ptr<WireServer> server = *WireServer::start("[::1]:0", {&display});
  std::unique_ptr<RemoteShown> shown;

  Room() {
    InstalledProjector left;
    left.name = "left";
    left.lens = Pinhole::from_field_of_view(kWidth, kHeight, 1.0);
    auto opened = RemoteShown::open(
        {left}, {*scan::parse_pattern_display("left=[::1]:" + std::to_string(server->port()))}, 1, 7ms, clock);
    EXPECT_TRUE(opened) << opened.error().message();
    shown = *std::move(opened);
  }
  void tell(std::uint64_t number, TimePoint at) {
    const std::lock_guard lock(display.mutex);
    display.shown.push_back({number, at});
  }
};

TEST(RemoteShown, knows_when_a_picture_was_lit_however_slowly_the_display_draws) {
  Room room;
  const TimePoint lit = room.clock.now() - 300ms;
  room.tell(1, lit);
  const TimePoint opened = room.clock.now() - 100ms;
  const auto told = room.shown->between(opened, opened + 40ms);
  ASSERT_TRUE(told) << told.error().message();
  EXPECT_TRUE(told->is_show);
  ASSERT_EQ(told->pictures.size(), 1u);
  // Its own latency is 7 ms; both network delays were zero, so there is no uncertainty.
  EXPECT_LT(std::chrono::abs(told->pictures[0].lit_at - (lit + 7ms)), 1us);
  EXPECT_EQ(told->pictures[0].number, 1u);
  ASSERT_EQ(told->until.size(), 1u);
  EXPECT_EQ(told->until[0].number, 1u);
  EXPECT_GE(told->until[0].at, opened + 40ms);
}

TEST(RemoteShown, reports_and_counts_each_picture_once) {
  Room room;
  room.tell(1, room.clock.now() - 300ms);
  const auto first = room.shown->between(room.clock.now() - 100ms, room.clock.now() - 60ms);
  ASSERT_TRUE(first) << first.error().message();
  room.tell(2, room.clock.now());
  room.clock.advance(200ms);
  const auto second = room.shown->between(room.clock.now() - 100ms, room.clock.now() - 60ms);
  ASSERT_TRUE(second) << second.error().message();
  ASSERT_EQ(second->pictures.size(), 1u);
  EXPECT_EQ(second->pictures[0].number, 2u);
  EXPECT_EQ(second->until[0].number, 2u);
}

TEST(RemoteShown, counts_anew_after_a_restart_of_the_display) {
  Room room;
  room.tell(500, room.clock.now() - 300ms);
  ASSERT_TRUE(room.shown->between(room.clock.now() - 100ms, room.clock.now() - 60ms));
  {
    const std::lock_guard lock(room.display.mutex);
    room.display.shown.clear();
  }
  room.tell(1, room.clock.now());
  room.clock.advance(300ms);
  const auto told = room.shown->between(room.clock.now() - 100ms, room.clock.now() - 60ms);
  ASSERT_TRUE(told) << told.error().message();
  ASSERT_EQ(told->pictures.size(), 1u) << "it waits for number 501";
  EXPECT_EQ(told->pictures[0].number, 1u);
}

}  // namespace
}  // namespace cyclorama::healing
