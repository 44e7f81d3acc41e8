// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <linux/input-event-codes.h>

#include <cmath>
#include <deque>
#include <filesystem>

#include "drivers/input/evdev/evdev_device.h"
#include "drivers/input/input_watch.h"

namespace cyclorama::input {
namespace {

using namespace std::chrono_literals;
using testing::ElementsAre;
using testing::HasSubstr;

const TimePoint kNow(10s);

InputDescription gamepad() {
  return {"Pad", {BTN_GAMEPAD}, {}, {{ABS_X, {-32768, 32767}}, {ABS_Y, {-32768, 32767}}, {ABS_RX, {-32768, 32767}}}};
}
InputDescription keyboard() {
  return {"Keys", {KEY_UP, KEY_DOWN, KEY_LEFT, KEY_RIGHT, KEY_W, KEY_A, KEY_S, KEY_D, KEY_Q, KEY_E}, {}, {}};
}
InputDescription space_mouse() { return {"SpaceNavigator", {}, {REL_X, REL_Y, REL_Z, REL_RX, REL_RY, REL_RZ}, {}}; }

TEST(InputKind, is_detected_by_the_devices_capabilities) {
  EXPECT_EQ(kind_of(gamepad()), InputKind::kGamepad);
  EXPECT_EQ(kind_of(keyboard()), InputKind::kKeyboard);
  EXPECT_EQ(kind_of(space_mouse()), InputKind::kSpaceMouse);
  EXPECT_EQ(kind_of({"Mouse", {BTN_LEFT}, {REL_X, REL_Y, REL_WHEEL}, {}}), std::nullopt);
  EXPECT_EQ(kind_of({"Power", {KEY_POWER}, {}, {}}), std::nullopt);
  EXPECT_EQ(kind_of({"Touch pad", {BTN_TOUCH}, {}, {{ABS_X, {0, 100}}, {ABS_Y, {0, 100}}}}), std::nullopt);
}

TEST(InputSteering, follows_the_sticks_of_a_gamepad) {
  InputSteering pad(InputKind::kGamepad, gamepad());
  EXPECT_TRUE(pad.command(kNow).is_rest());
  pad.take({EV_ABS, ABS_Y, -32768}, kNow);
  pad.take({EV_ABS, ABS_X, 32767}, kNow);
  pad.take({EV_ABS, ABS_RX, -32768}, kNow);
  const InputCommand command = pad.command(kNow);
  EXPECT_NEAR(command.forward, 1.0, 1e-3);
  EXPECT_NEAR(command.right, 1.0, 1e-3);
  EXPECT_NEAR(command.turn, -1.0, 1e-3);
  pad.take({EV_ABS, ABS_Y, 3000}, kNow);
  EXPECT_EQ(pad.command(kNow).forward, 0.0) << "a worn stick rests off its middle";
}

TEST(InputSteering, follows_keys_until_they_are_released) {
  InputSteering keys(InputKind::kKeyboard, keyboard());
  keys.take({EV_KEY, KEY_W, 1}, kNow);
  keys.take({EV_KEY, KEY_LEFT, 1}, kNow);
  keys.take({EV_KEY, KEY_D, 1}, kNow);
  EXPECT_EQ(keys.command(kNow + 60s), (InputCommand{1.0, 1.0, -1.0}));
  keys.take({EV_KEY, KEY_S, 2}, kNow);
  EXPECT_EQ(keys.command(kNow).forward, 0.0) << "both ways is none";
  for (const auto key : {KEY_W, KEY_LEFT, KEY_D, KEY_S}) keys.take({EV_KEY, static_cast<std::uint16_t>(key), 0}, kNow);
  EXPECT_TRUE(keys.command(kNow).is_rest());
}

TEST(InputSteering, counts_each_press_of_the_buttons_for_stops) {
  InputDescription clicker = keyboard();
  clicker.keys.insert({KEY_PAGEDOWN, KEY_PAGEUP});
  InputSteering keys(InputKind::kKeyboard, clicker);
  for (const std::int32_t value : {1, 2, 2, 0, 1}) keys.take({EV_KEY, KEY_PAGEDOWN, value}, kNow);
  EXPECT_EQ(keys.take_steps(), 2);
  EXPECT_EQ(keys.take_steps(), 0);
  keys.take({EV_KEY, KEY_PAGEUP, 1}, kNow);
  EXPECT_EQ(keys.take_steps(), -1);
  EXPECT_TRUE(keys.command(kNow).is_rest());
}

TEST(InputSteering, counts_each_press_of_the_key_for_the_language) {
  InputDescription description = keyboard();
  description.keys.insert(KEY_L);
  InputSteering keys(InputKind::kKeyboard, description);
  for (const std::int32_t value : {1, 2, 2, 0, 1}) keys.take({EV_KEY, KEY_L, value}, kNow);
  EXPECT_EQ(keys.take_languages(), 2);
  EXPECT_EQ(keys.take_languages(), 0);
  EXPECT_EQ(keys.take_steps(), 0);
}

TEST(InputSteering, ignores_a_silent_spacemouse_after_a_while) {
  InputSteering cap(InputKind::kSpaceMouse, space_mouse());
  cap.take({EV_REL, REL_Y, -350}, kNow);
  cap.take({EV_REL, REL_RZ, 200}, kNow);
  EXPECT_NEAR(cap.command(kNow).forward, 1.0, 1e-9);
  EXPECT_GT(cap.command(kNow + 100ms).turn, 0.3);
  EXPECT_TRUE(cap.command(kNow + 200ms).is_rest());
}

TEST(InputSteering, is_at_most_one_and_finite_for_any_events) {
  InputDescription broken = gamepad();
  broken.absolute[ABS_X] = {0, 0};
  broken.absolute[ABS_Y] = {5, -5};
  for (const InputKind kind : {InputKind::kGamepad, InputKind::kSpaceMouse, InputKind::kKeyboard}) {
    InputSteering steering(kind, broken);
    for (const std::int32_t value : {0, 1, -1, 2147483647, -2147483647 - 1}) {
      for (std::uint16_t type = 0; type < 5; ++type) {
        for (std::uint16_t code = 0; code < 16; ++code) steering.take({type, code, value}, kNow);
      }
      const InputCommand command = steering.command(kNow);
      for (const double part : {command.forward, command.right, command.turn}) EXPECT_LE(std::abs(part), 1.0);
    }
  }
}

/// A machine whose devices the test plugs and unplugs.
struct FakeMachine {
  struct Plug {
    InputDescription description;
    std::deque<InputEvent> events;
    bool gone = false;
    bool locked = false;
  };
  std::map<std::string, std::shared_ptr<Plug>> plugs;
  int opened = 0;

  class Device final : public InputDevice {
   public:
    explicit Device(std::shared_ptr<Plug> plug) : plug_(std::move(plug)) {}
    [[nodiscard]] const InputDescription& description() const override { return plug_->description; }
    Result<std::optional<InputEvent>> next() override {
      if (plug_->gone) return Error(ErrorCode::kUnavailable, "gone");
      if (plug_->events.empty()) return std::optional<InputEvent>{};
      const InputEvent event = plug_->events.front();
      plug_->events.pop_front();
      return std::optional<InputEvent>(event);
    }

   private:
    std::shared_ptr<Plug> plug_;
  };

  InputDevices devices() {
    return {[this] {
              std::vector<std::string> paths;
              for (const auto& [path, plug] : plugs) paths.push_back(path);
              return paths;
            },
            [this](const std::string& path) -> Result<std::unique_ptr<InputDevice>> {
              ++opened;
              if (plugs[path]->locked) return Error(ErrorCode::kSystem, "opening '" + path + "': Permission denied");
              return std::unique_ptr<InputDevice>(std::make_unique<Device>(plugs[path]));
            }};
  }
};

TEST(InputWatch, follows_devices_as_they_are_plugged_and_unplugged) {
  FakeMachine machine;
  InputWatch watch(machine.devices());
  watch.update(kNow);
  EXPECT_EQ(watch.open_count(), 0u);
  auto plug = machine.plugs["event3"] =
      std::make_shared<FakeMachine::Plug>(FakeMachine::Plug{keyboard(), {}, false, false});
  plug->events = {{EV_KEY, KEY_UP, 1}};
  watch.update(kNow + 500ms);
  EXPECT_TRUE(watch.command(kNow).is_rest()) << "not looked yet";
  watch.update(kNow + 1s);
  EXPECT_EQ(watch.command(kNow).forward, 1.0);
  EXPECT_THAT(watch.sentences(), ElementsAre("keyboard 'Keys'"));
  plug->gone = true;
  machine.plugs.clear();
  watch.update(kNow + 1100ms);
  EXPECT_TRUE(watch.command(kNow).is_rest()) << "pulled out with the key down";
  machine.plugs["event3"] =
      std::make_shared<FakeMachine::Plug>(FakeMachine::Plug{gamepad(), {{EV_ABS, ABS_Y, -32768}}, false, false});
  watch.update(kNow + 2s);
  watch.update(kNow + 3s);
  EXPECT_NEAR(watch.command(kNow).forward, 1.0, 1e-3);
}

TEST(InputWatch, ignores_devices_that_cannot_steer_and_retries_those_that_do_not_open) {
  FakeMachine machine;
  machine.plugs["event0"] =
      std::make_shared<FakeMachine::Plug>(FakeMachine::Plug{{"Power", {KEY_POWER}, {}, {}}, {}, false, false});
  auto locked = machine.plugs["event1"] =
      std::make_shared<FakeMachine::Plug>(FakeMachine::Plug{keyboard(), {}, false, true});
  InputWatch watch(machine.devices());
  for (int i = 0; i < 5; ++i) watch.update(kNow + i * 1s);
  EXPECT_EQ(machine.opened, 1 + 5);
  EXPECT_THAT(watch.sentences(), ElementsAre(HasSubstr("Permission denied")));
  locked->locked = false;
  watch.update(kNow + 10s);
  EXPECT_EQ(watch.open_count(), 1u);
}

TEST(InputWatch, notices_presses_of_help_on_any_keyboard_once_each) {
  FakeMachine machine;
  auto keys = machine.plugs["a"] = std::make_shared<FakeMachine::Plug>(FakeMachine::Plug{keyboard(), {}, false, false});
  auto remote = machine.plugs["b"] =
      std::make_shared<FakeMachine::Plug>(FakeMachine::Plug{{"Remote", {KEY_HELP}, {}, {}}, {}, false, false});
  InputWatch watch(machine.devices());
  watch.update(kNow);
  EXPECT_FALSE(watch.take_help());
  keys->events = {{EV_KEY, KEY_F1, 1}, {EV_KEY, KEY_F1, 2}};
  watch.update(kNow + 10ms);
  EXPECT_TRUE(watch.take_help());
  EXPECT_FALSE(watch.take_help());
  keys->events = {{EV_KEY, KEY_F1, 2}, {EV_KEY, KEY_F1, 0}, {EV_KEY, KEY_W, 1}};
  watch.update(kNow + 20ms);
  EXPECT_FALSE(watch.take_help()) << "held, and let go";
  remote->events = {{EV_KEY, KEY_HELP, 1}};
  watch.update(kNow + 30ms);
  EXPECT_TRUE(watch.take_help());
}

TEST(InputWatch, adds_up_devices_and_survives_a_flood_of_events) {
  FakeMachine machine;
  auto keys = machine.plugs["a"] = std::make_shared<FakeMachine::Plug>(FakeMachine::Plug{keyboard(), {}, false, false});
  auto mad = machine.plugs["b"] = std::make_shared<FakeMachine::Plug>(FakeMachine::Plug{gamepad(), {}, false, false});
  keys->events = {{EV_KEY, KEY_UP, 1}};
  mad->events.assign(100'000, {EV_ABS, ABS_Y, -32768});
  InputWatch watch(machine.devices());
  watch.update(kNow);
  EXPECT_GT(mad->events.size(), 90'000u);
  EXPECT_EQ(watch.command(kNow).forward, 1.0) << "limited";
}

TEST(Evdev, refuses_files_that_are_not_devices) {
  const std::string folder = testing::TempDir() + "/no_devices";
  std::filesystem::create_directories(folder);
  EXPECT_EQ(open_evdev(folder + "/event0").error().code(), ErrorCode::kNotFound);
  EXPECT_EQ(open_evdev("/dev/null").error().code(), ErrorCode::kBadData);
  EXPECT_TRUE(evdev_devices(folder).list().empty());
  EXPECT_TRUE(evdev_devices("/nowhere").list().empty());
}

}  // namespace
}  // namespace cyclorama::input
