// SPDX-License-Identifier: Apache-2.0
/// test-parts: simulates a museum's parts as shown on the operator page: a tour, a display of three heads, a tracker
/// and a calibrator. For viewing the page in a browser.
#include <cmath>
#include <cstdio>
#include <numbers>

#include "common/image/jpeg.h"
#include "common/process/program.h"
#include "tests/doubles/fake_calibrator.h"
#include "tests/doubles/fake_process.h"

namespace cyclorama {
namespace {

using namespace std::chrono_literals;

/// Vaults in front of an evening sky, seen from `heading`.
RgbImage vaults(int width, int height, double heading) {
  RgbImage picture(width, height);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      const double across = 3.0 * x / width + heading;
      const double up = 1.0 - static_cast<double>(y) / height;
      const double arch = 0.35 + 0.45 * std::abs(std::sin(across * std::numbers::pi));
      const double glow = up < arch ? 0.75 - 0.5 * up : 0.12 + 0.1 * std::sin(40.0 * across) * std::sin(25.0 * up);
      const double shade = up < 0.15 ? 0.35 : glow;
      picture.at(x, y)[0] = static_cast<std::uint8_t>(255.0 * std::clamp(shade, 0.0, 1.0));
      picture.at(x, y)[1] = static_cast<std::uint8_t>(190.0 * std::clamp(shade * 0.9, 0.0, 1.0));
      picture.at(x, y)[2] = static_cast<std::uint8_t>(130.0 * std::clamp(shade * 0.8 + 0.08, 0.0, 1.0));
    }
  }
  return picture;
}

struct Parts {
  FakeProcess tour;
  FakeProcess display{"display"};
  FakeProcess tracker{"tracker"};
  FakeProcess projectors{"projectors"};
  FakeCalibrator calibrator;

  Parts(bool is_unwell, int tour_port) : tour("tour", tour_port) {
    tour.inspection.set_state("Visiting 'The grotto', 19.8 frames a second, 1 display, steered by a wand.", true);
    tour.inspection.set_fact("title", "The grotto");
    tour.inspection.set_fact("credits", "A picture made for a test.");
    tour.inspection.set_fact("triangles", "6210334");
    tour.inspection.set_fact("steered_by", "wand 0");
    for (const auto& [name, value] : {std::pair("frames_per_second", 19.8),
                                      {"bytes_per_frame", 412000.0},
                                      {"balance_efficiency", 0.96},
                                      {"heading_deg", 12.0},
                                      {"eye_x_m", 1.2},
                                      {"eye_z_m", -3.4},
                                      {"forward_m_per_s", 0.4},
                                      {"sideways_m_per_s", 0.0}}) {
      tour.inspection.set_gauge(name, value);
    }
    for (const auto& [name, time] : {std::pair("capture", 12ms),
                                     {"detect", 4ms},
                                     {"pose", 1ms},
                                     {"steer", 1ms},
                                     {"farm_round_trip", 46ms},
                                     {"decode", 6ms},
                                     {"wait", 8ms},
                                     {"draw", 2ms},
                                     {"shutter_to_photon", 80ms}}) {
      tour.inspection.add_stage_time(name, time);
    }
    display.inspection.set_state("Shows the tour at [::1]:7403: 19.8 frames per second.", true);
    display.inspection.set_fact("heads", "3");
    display.inspection.set_gauge("awake", 1.0);
    double heading = 0.0;
    for (const char* const head : {"left", "middle", "right"}) {
      const bool is_dark = is_unwell && std::string_view(head) == "right";
      display.inspection.set_gauge(std::string("lit: ") + head, is_dark ? 0.0 : 1.0);
      auto picture = std::make_shared<const RgbImage>(is_dark ? RgbImage(640, 400) : vaults(640, 400, heading));
      display.inspection.set_picture(std::string("projector/") + head, picture);
      heading += 1.0;
    }
    display.inspection.set_picture("panorama", std::make_shared<const RgbImage>(vaults(1280, 400, 0.0)));
    tracker.inspection.set_state(
        is_unwell ? "No camera is at usb-0000:00:14.0-2." : "Follows wand 0 at 30.0 pictures per second.", !is_unwell);
    tracker.inspection.set_gauge("frames_per_second", is_unwell ? 0.0 : 30.0);
    tracker.inspection.set_picture("camera", std::make_shared<const RgbImage>(vaults(640, 480, 0.4)));
    tell_lamps(is_unwell);
    const auto jpeg = JpegEncoder().encode(vaults(640, 480, 2.0), JpegOptions{});
    CHECK(jpeg);
    calibrator.messages = told_calibration(8, {reinterpret_cast<const char*>(jpeg->data()), jpeg->size()});
    calibrator.messages.front().set_question(
        "Turn the turntable to 30.0 degrees to the left, then press Enter (or type the angle that it stands at; q to "
        "stop): ");
    calibrator.step_takes = 1500ms;
    tell_healing(&calibrator.inspection);
  }

  /// Publishes the lamps' state in the same way as cyclorama-projectors.
  void tell_lamps(bool is_unwell) {
    wire::Table table;
    table.set_name("projectors");
    for (const char* const column : {"name", "level", "sentence", "remedy"}) table.add_columns(column);
    for (const char* const name : {"left", "middle", "right"}) {
      const bool is_off = is_unwell && std::string_view(name) == "right";
      wire::Row* const row = table.add_rows();
      for (const char* const cell :
           {name, is_off ? "fault" : "ok", is_off ? "Its lamp is off, though the museum is open." : "Its lamp is on.",
            is_off ? "Switch it on by its remote control." : ""}) {
        row->add_cells()->set_text(cell);
      }
    }
    projectors.inspection.set_table(std::move(table));
    projectors.inspection.set_state(
        is_unwell ? "2 of 3 projectors are as they should be." : "3 of 3 projectors are as they should be.",
        !is_unwell);
  }
};

}  // namespace
}  // namespace cyclorama

int main(int argc, char** argv) {
  cyclorama::Program program(
      "test-parts",
      "Pretends to be a museum's tour, display, tracker, calibrator and projectors; prints their addresses.");
  bool is_unwell = false;
  program.options().add_flag("--unwell", is_unwell, "The camera is out, and one projector dark");
  int tour_port = 0;
  program.options().add_option("--tour-port", tour_port, "Port of the tour; 0: a free one")->capture_default_str();
  return program.run(argc, argv, [&](const cyclorama::StopSignal& stop) -> cyclorama::Status {
    cyclorama::Parts parts(is_unwell, tour_port);
    std::printf("%s %s %s %s %s\n", parts.tour.address().c_str(), parts.display.address().c_str(),
                parts.tracker.address().c_str(), parts.calibrator.address().c_str(),
                parts.projectors.address().c_str());
    std::fflush(stdout);
    while (!stop.wait_until(cyclorama::SteadyClock().now() + std::chrono::seconds(1))) {
    }
    return cyclorama::Done{};
  });
}
