// SPDX-License-Identifier: Apache-2.0
// Runs the real display and calibrator in a museum that the calibrator simulates. A projector is bumped during the
// show, and the wall's error must fall again, even if the calibrator is killed and restarted meanwhile. One command
// must restore the previous calibration, and replaying the record twice must give the same corrections bit by bit. The
// truth is only used to bump projectors and to score the wall. healing_loop_test covers more cases.
//
//   healing_test DISPLAY CALIBRATOR
#include <fcntl.h>
#include <fmt/format.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <string>
#include <thread>
#include <vector>

#include "appliance/calibration/calibration_file.h"
#include "appliance/calibration/corrected_map.h"
#include "common/base/file.h"
#include "common/process/child.h"
#include "common/wire/calibration.grpc.pb.h"
#include "common/wire/inspection.grpc.pb.h"
#include "common/wire/show.grpc.pb.h"
#include "drivers/simulated/museum/presets.h"
#include "tests/data_sets/jpeg_tiles.h"
#include "tests/data_sets/true_calibration.h"
#include "tests/doubles/fake_tour.h"
#include "tests/support/bumped_show.h"

namespace cyclorama {
namespace {

constexpr int kWall = 1;  // Number of the projector that is bumped: the middle one.
constexpr const char* kBefore = "2026-11-21T10-00-00Z";

/// A child process that is killed by the destructor.
class Child {
 public:
  explicit Child(const std::vector<std::string>& command) : id_(::fork()) {
    CHECK(id_ >= 0);
    if (id_ > 0) return;
    std::vector<char*> arguments;
    for (const std::string& word : command) arguments.push_back(const_cast<char*>(word.c_str()));
    arguments.push_back(nullptr);
    ::execv(arguments[0], arguments.data());
    std::_Exit(127);
  }
  ~Child() { kill(SIGKILL); }
  Child(const Child&) = delete;
  Child& operator=(const Child&) = delete;
  void kill(int signal) {
    if (id_ <= 0) return;
    ::kill(id_, signal);
    ::waitpid(id_, nullptr, 0);
    id_ = -1;
  }

 private:
  pid_t id_;
};

/// Cuts the part that the display requested out of a full-circle picture.
RgbImage cut_out(const ShowContent& content, const Panorama& wanted) {
  RgbImage picture(wanted.width_px, wanted.height_px);
  for (int y = 0; y < picture.height(); ++y) {
    for (int x = 0; x < picture.width(); ++x) {
      const PanoramaPixel at = content.shape.pixel_of(wanted.direction_at({x + 0.5, y + 0.5}));
      const int u = static_cast<int>(std::clamp(at.u, 0.0, content.shape.width_px - 1.0));
      const int v = static_cast<int>(std::clamp(at.v, 0.0, content.shape.height_px - 1.0));
      std::copy_n(content.picture.at(u, v), 3, picture.at(x, y));
    }
  }
  return picture;
}

class Scenario {
 public:
  Scenario(std::string display, std::string calibrator, std::filesystem::path folder)
      : display_(std::move(display)), calibrator_(std::move(calibrator)), folder_(std::move(folder)) {}

  int run() {
    simulated::PresetOptions options;
    options.projector_width_px = 640;
    options.projector_height_px = 360;
    options.camera_megapixels = 0.3;
    auto preset = simulated::make_preset("cylinder126", 3, options);
    CHECK(preset && simulated::write_preset(*preset, folder_));
    truth_ = preset->truth;
    auto museum = simulated::TrueMuseum::make(preset->installation, truth_);
    CHECK(museum && calibration::save_calibration(folder_, true_calibration(*museum, kBefore)) &&
          calibration::save_calibration(folder_, true_calibration(*museum, "2026-11-22T10-00-00Z")));
    installation_ = preset->installation;

    const auto tour = FakeTour::start();
    const std::string installation = folder_ / "installation.toml";
    Child shown({display_, "--installation", installation, "--tour", tour->address(), "--listen", display_address(),
                 "--width", "1536", "--refresh-hz", "15", "--calibration", folder_});
    expect(tour->wait_for_display(), "the display asks for a picture");
    show_picture(*tour);
    std::thread tour_again([&] {  // Starts the show again whenever the display reconnects.
      for (int known = 1; !is_over_;) {
        std::this_thread::sleep_for(std::chrono::milliseconds(50));
        if (tour->displays == known || !tour->wait_for_display()) continue;
        known = tour->displays;
        show_picture(*tour);
      }
    });
    {
      Child heals(calibrator_command("record"));
      place_cameras();
      expect(says("keeps 3 projectors in place", 120), "the calibrator keeps the wall in its place");
      const double before_px = off_px();
      bump({0.004, -0.006, 0.002, 0.004, 0.0, -0.003});
      const double bumped_px = off_px();
      expect(bumped_px > 3.0, "the bump is one");
      expect(falls_below(1.0, 120), "the wall heals");
      fmt::print("off by {:.2f} px, bumped {:.2f} px, healed {:.2f} px\n", before_px, bumped_px, off_px());
      expect(display_says("from where it stands now"), "the display draws for where the projector stands now");
      expect(says("keeps 3 projectors in place", 30), "all is well again");
      expect(realign(), "it can be told to realign");
      bump({-0.003, 0.003, 0.0, 0.0, 0.003, 0.0});
      heals.kill(SIGKILL);  // At once: during the recovery, or before it detected the bump.
    }
    {
      const double bumped_px = off_px();
      expect(bumped_px > 1.5, "it was killed before the wall was healed");
      Child heals(calibrator_command("again"));
      expect(falls_below(1.0, 120), "a calibrator that comes back goes on");
      fmt::print("bumped to {:.2f} px when it was killed, healed {:.2f} px\n", bumped_px, off_px());
      expect(restore() == kBefore, "one command brings the calibration of before back");
      expect(calibration::read_calibration(folder_)->date == kBefore && display_says(kBefore), "displays draw for it");
      heals.kill(SIGTERM);
    }
    for (const auto& record : std::filesystem::directory_iterator(folder_ / "record")) {
      std::string once;
      for (const char* const time : {"once", "twice"}) {
        const auto again = run_child({calibrator_, "--replay", record.path()}, {std::chrono::seconds(120), 1 << 20});
        expect(again && again->exit_code == 0, fmt::format("the record is found again bit by bit, {}", time));
        if (again && again->exit_code != 0) fmt::print("{}\n", again->output);
        if (again && once.empty()) once = again->output;
        expect(again && again->output == once, "and says the same");
      }
    }
    shown.kill(SIGTERM);
    is_over_ = true;
    tour_again.join();
    std::puts(problems_ == 0 ? "healing: ok" : "healing: failed");
    return problems_ == 0 ? 0 : 1;
  }

 private:
  void expect(bool is_so, const std::string& what) {
    fmt::print("{}: {}\n", is_so ? "so" : "NOT so", what);
    std::fflush(stdout);
    problems_ += is_so ? 0 : 1;
  }
  [[nodiscard]] std::string display_address() const { return "unix:" + (folder_ / "display.sock").string(); }
  [[nodiscard]] std::string calibrator_address() const { return "unix:" + (folder_ / "calibrator.sock").string(); }
  [[nodiscard]] std::vector<std::string> calibrator_command(const std::string& record) const {
    return {calibrator_,          "--simulated",   folder_ / "installation.toml",
            "--folder",           folder_,         "--listen",
            calibrator_address(), "--display",     display_address(),
            "--record",           folder_ / record};
  }

  void show_picture(FakeTour& tour) {
    const auto wanted = from_wire(tour.hello.wanted());
    CHECK(wanted && std::holds_alternative<Panorama>(wanted->shape));
    static const ShowContent content = painted_content(6144, 3);
    static std::uint64_t number = 0;
    tour.send_all(
        frame_messages(++number, cut_out(content, std::get<Panorama>(wanted->shape)), wanted->shape, 0.0, 256));
  }

  void place_cameras() {
    const auto channel = make_channel(calibrator_address());
    const auto stub = wire::Healing::NewStub(*channel);
    wire::PlacedCameras placed;
    grpc::Status status;
    for (int tries = 0; tries < 100; ++tries) {  // It may still be starting.
      grpc::ClientContext context;
      context.set_deadline(std::chrono::system_clock::now() + std::chrono::seconds(150));
      status = stub->PlaceCameras(&context, {}, &placed);
      if (status.error_code() != grpc::StatusCode::UNAVAILABLE) break;
      std::this_thread::sleep_for(std::chrono::milliseconds(100));
    }
    expect(status.ok() && placed.cameras_size() == 3, "the cameras are placed " + status.error_message());
    for (const auto& camera : placed.cameras())
      fmt::print("{}: {} places, {:.3f} px\n", camera.name(), camera.places(), camera.rms_px());
  }
  bool realign() {
    const auto channel = make_channel(calibrator_address());
    grpc::ClientContext context;
    wire::RealignReply answer;
    return wire::Healing::NewStub(*channel)->Realign(&context, {}, &answer).ok();
  }
  /// Restores the previous calibration and returns the date of the one now in use, or the error.
  std::string restore() {
    const auto channel = make_channel(calibrator_address());
    grpc::ClientContext context;
    wire::RestoreReply answer;
    const grpc::Status status = wire::Calibrator::NewStub(*channel)->Restore(&context, {}, &answer);
    return status.ok() ? answer.date() : status.error_message();
  }
  [[nodiscard]] static std::string state_at(const std::string& address) {
    const auto channel = make_channel(address);
    grpc::ClientContext context;
    context.set_deadline(std::chrono::system_clock::now() + std::chrono::seconds(2));
    wire::ProcessStatus status;
    const auto answered = wire::Inspection::NewStub(*channel)->GetStatus(&context, {}, &status);
    std::string all = answered.ok() ? status.state() : answered.error_message();
    for (const wire::Fact& fact : status.facts()) all += "\n" + fact.value();
    return all;
  }
  bool says(const std::string& text, int seconds) {
    std::string state;
    for (int i = 0; i < 10 * seconds; ++i) {
      state = state_at(calibrator_address());
      if (state.find(text) != std::string::npos) return true;
      std::this_thread::sleep_for(std::chrono::milliseconds(100));
    }
    fmt::print("it says: {}\n", state);
    return false;
  }
  bool display_says(const std::string& text) {
    for (int i = 0; i < 100; ++i) {
      if (state_at(display_address()).find(text) != std::string::npos) return true;
      std::this_thread::sleep_for(std::chrono::milliseconds(100));
    }
    return false;
  }

  void bump(const std::array<double, 6>& numbers) {
    calibration::PoseStep step;
    for (int i = 0; i < 6; ++i) step[i] = numbers[static_cast<std::size_t>(i)];
    auto& pose = truth_.projectors[kWall].T_room_projector;
    pose = calibration::stepped(pose, step);
    CHECK(write_file_atomically(simulated::truth_path_beside(folder_ / "installation.toml"), truth_.text()));
  }
  /// Returns the error of the bumped projector's map with which displays draw, in pixels.
  [[nodiscard]] double off_px() const {
    auto museum = simulated::TrueMuseum::make(installation_, truth_);
    const auto calibration = calibration::read_calibration(folder_);
    CHECK(museum && calibration);
    calibration::MeasuredMap map = calibration->projectors[kWall].map;
    if (const auto show = calibration::read_show(folder_ / calibration::kCorrectionFile))
      map = calibration::corrected_map(map, show->projectors[kWall], installation_.wall, installation_.sweet_spot);
    return map_off_px(*museum, kWall, map);
  }
  [[nodiscard]] bool falls_below(double px, int seconds) const {
    for (int i = 0; i < 5 * seconds; ++i) {
      if (off_px() < px) return true;
      std::this_thread::sleep_for(std::chrono::milliseconds(200));
    }
    fmt::print("still off by {:.2f} px; {}\n", off_px(), state_at(calibrator_address()));
    return false;
  }

  std::string display_;
  std::string calibrator_;
  std::filesystem::path folder_;
  simulated::MuseumTruth truth_;
  Installation installation_;
  std::atomic<bool> is_over_{false};
  int problems_ = 0;
};

}  // namespace
}  // namespace cyclorama

int main(int argc, char** argv) {
  if (argc != 3) {
    std::fputs("healing_test DISPLAY CALIBRATOR\n", stderr);
    return 2;
  }
  std::string folder = (std::filesystem::temp_directory_path() / "healing-XXXXXX").string();
  if (::mkdtemp(folder.data()) == nullptr) return 1;
  const int rc = cyclorama::Scenario(argv[1], argv[2], folder).run();
  if (rc == 0) std::filesystem::remove_all(folder);
  return rc;
}
