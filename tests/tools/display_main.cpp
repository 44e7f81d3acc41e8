// SPDX-License-Identifier: Apache-2.0
// test-display: the real display with a wrong clock, for tests/bench/display/sync.py. It draws into memory and writes
// one line per refresh: its time on the machine's true clock; its synchronised number, or - for none; the frame that
// was shown; the lateness of the frame and of the heading in refreshes; the heading; and how long before the
// synchronised refresh drawing began, in milliseconds. At the end it writes its gauges.
#include <fmt/os.h>

#include "appliance/display/display.h"
#include "common/process/program.h"
#include "common/room/installation.h"
#include "tests/doubles/fake_skewed_clock.h"

namespace cyclorama {
namespace {

struct Options {
  std::string installation;
  std::string log;
  double skew_ms = 0.0;
  double drift_ppm = 0.0;
  display::DisplayOptions display;
};

class RefreshLog {
 public:
  RefreshLog(const std::string& path, const FakeSkewedClock& clock) : file_(fmt::output_file(path)), clock_(clock) {}
  void add(const display::RefreshEvent& event) {
    if (event.is_first_of_frame) frame_ = event.frame_number;
    file_.print("{} {} {} {} {} {:.6f} {:.3f}\n", to_nanoseconds(clock_.true_time(event.presented.at)),
                event.synchronised_refresh ? fmt::to_string(*event.synchronised_refresh) : "-", frame_,
                event.late(event.frame_due), event.late(event.heading_due), event.heading_rad,
                to_milliseconds(event.drawn_ahead));
  }
  void add(const wire::Gauge& gauge) { file_.print("# {} {}\n", gauge.name(), gauge.value()); }

 private:
  fmt::ostream file_;
  const FakeSkewedClock& clock_;
  std::uint64_t frame_ = 0;
};

Status run(Options options, const StopSignal& stop) {
  TRY_ASSIGN(options.display.installation, read_installation(options.installation));
  const auto ms = [](double value) {
    return std::chrono::duration_cast<Duration>(std::chrono::duration<double, std::milli>(value));
  };
  const FakeSkewedClock clock(ms(options.skew_ms), options.drift_ppm);
  options.display.system_clock = [skew = ms(options.skew_ms)] { return std::chrono::system_clock::now() + skew; };
  RefreshLog log(options.log, clock);
  options.display.on_refresh = [&log](const display::RefreshEvent& event) { log.add(event); };
  TRY_ASSIGN(const std::unique_ptr<display::Display> display,
             display::Display::start(std::move(options.display), clock));
  while (!stop.requested()) {
    display->serve(clock.now() + std::chrono::milliseconds(100));
  }
  const wire::ProcessStatus status = display->inspection().status();
  for (const wire::Gauge& gauge : status.gauges()) log.add(gauge);
  return Done{};
}

}  // namespace
}  // namespace cyclorama

int main(int argc, char** argv) {
  using namespace cyclorama;
  Program program("test-display", "The display with a clock that is wrong; draws into memory and logs every refresh.");
  Options options;
  CLI::App& app = program.options();
  app.add_option("--installation", options.installation)->required();
  app.add_option("--tour", options.display.tour)->required();
  app.add_option("--listen", options.display.listen);
  app.add_option("--log", options.log)->required();
  app.add_option("--skew-ms", options.skew_ms, "How far its clocks are ahead of the machine's");
  app.add_option("--drift-ppm", options.drift_ppm, "How much faster its clock goes");
  app.add_option("--refresh-hz", options.display.refresh_hz);
  app.add_option("--width", options.display.width_px);
  return program.run(argc, argv, [&](const StopSignal& stop) { return run(std::move(options), stop); });
}
