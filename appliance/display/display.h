// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "appliance/display/calibration_watch.h"
#include "appliance/display/caption.h"
#include "appliance/display/frame_assembler.h"
#include "appliance/display/make_output.h"
#include "appliance/display/pattern_service.h"
#include "appliance/display/present_thread.h"
#include "appliance/display/reach_screen.h"
#include "appliance/display/refresh_reporter.h"
#include "appliance/display/show_stream.h"
#include "appliance/display/shown_service.h"
#include "appliance/display/tour_clock.h"
#include "common/opening/hours_override.h"
#include "common/room/installation.h"
#include "common/wire/channel.h"
#include "common/wire/inspection_service.h"

namespace cyclorama::display {

struct DisplayOptions {
  Installation installation;
  std::string tour;                ///< HOST:PORT of the tour to connect to.
  std::string listen = "[::1]:0";  ///< HOST:PORT that serves inspection, patterns and ShownPictures.
  int width_px = 1024;             ///< Width of the requested picture.
  int height_px = 0;               ///< Height of that picture; 0: such that pixels are square.
  double refresh_hz = 30.0;
  OutputChoice output;
  int decode_threads = 2;
  /// A calibration that requests no pattern for this long is ended.
  Duration patterns_idle = std::chrono::minutes(10);
  /// The calibration's folder; empty: the heads draw as the installation describes.
  std::filesystem::path calibration;
  std::filesystem::path attract_picture;  ///< PNG or JPEG; empty: the built-in evening sky.
  AttractTimes attract_times;
  OpeningHours hours;                    ///< Outside of these hours the heads are dark.
  std::filesystem::path hours_override;  ///< File with the operator's override of the hours for one day; empty: none.
  SystemClock system_clock = std::chrono::system_clock::now;
  std::filesystem::path reach;  ///< File of common/reach, by which the wall shows how to reach the operator page.
  std::filesystem::path help_pressed;  ///< File whose time changes when somebody presses Help. See ReachScreen.
  /// Called after each step while the output opens. May be null.
  std::function<void()> on_start_step;
  /// For tools: called on the main thread for every refresh. May be null.
  std::function<void(const RefreshEvent&)> on_refresh;
};

/// Receives one projection computer's picture as tiles and shows it on its heads. Its threads:
///
///   main             serve(): connection, reports, state for inspection
///   gRPC's threads   pass messages to the assembler, and headings to the presenter
///   decode (N)       decode JPEG tiles
///   present          owns GL; draws and shows
///
/// While the connection to the tour is lost, the heads show the last complete frame, and later the attract picture; the
/// display keeps trying to reconnect. A lost output is reopened in the same way (OutputSupervisor). Any client that can
/// reach the display's port may replace the show with patterns. Bound to the main thread.
class Display : private FrameSink {
 public:
  /// Opens the output and starts to show pictures. `clock` must outlive the display. Errors: kInvalidArgument if an
  /// option or the installation cannot work, with the reason; kBusy if the port of `listen` is taken; kUnavailable if
  /// there is no GL.
  static Result<std::unique_ptr<Display>> start(DisplayOptions options, const Clock& clock);
  ~Display() override;

  /// Does the main thread's part of the work until `deadline`.
  void serve(TimePoint deadline);

  /// False if the graphics driver hangs; for the watchdog.
  [[nodiscard]] bool is_presenting() const { return present_->is_alive(); }
  [[nodiscard]] InspectionService& inspection() { return inspection_; }
  [[nodiscard]] int port() const { return server_->port(); }

 private:
  Display(DisplayOptions options, const Clock& clock);
  Status prepare();
  Result<std::vector<HeadPlan>> first_heads();
  void describe(const std::vector<HeadPlan>& heads);
  void describe_calibration(const std::string& date, const std::vector<std::string>& lacking,
                            const std::vector<std::string>& corrected);
  void refuse_calibration(const Error& why);
  void on_message(wire::ShowMessage message);
  void take_caption(const wire::Caption& message);
  void write(Caption caption);
  void frame_ready(DisplayFrame frame) override;
  void frame_dropped(std::uint64_t number, const std::string& reason) override;
  void add_drop(std::uint64_t number, const std::string& reason);  // Precondition: mutex_ is held.
  void free_shown();
  void note_output();
  void keep_hours();
  void keep_reach();
  void keep_calibration();
  void keep_connected();
  void hang_up();
  void request_time();
  void report_refreshes();
  void report_drops();
  void serve_watchers();
  void publish_state();
  [[nodiscard]] bool is_decoded_for(const std::vector<HeadFootprint>& heads) const;
  [[nodiscard]] std::string step_sentence() const;
  [[nodiscard]] std::string calibration_sentence() const;

  const DisplayOptions options_;
  const Clock& clock_;
  Projection wanted_;
  std::atomic<bool> is_awake_{true};  // Shared with the output, which reads it.
  InspectionService inspection_{"display"};
  RefreshReporter reporter_;
  PresentMailbox mailbox_;
  PatternService patterns_;
  std::optional<ReachScreen> reach_;       // Nothing without the file's name.
  std::unique_ptr<ShownHistory> history_;  // Created in prepare(), before the first request.
  std::unique_ptr<ShownService> showing_;
  TourClock tour_clock_;
  OverriddenHours hours_;
  std::shared_ptr<grpc::Channel> channel_;
  wire::DisplayHello hello_;

  struct Drop {
    std::uint64_t number;
    std::string reason;
  };
  std::mutex mutex_;  // Guards the next three members; never taken by the present thread.
  std::vector<Drop> drops_;
  std::vector<std::string> depth_troubles_;
  std::uint64_t newest_ready_ = 0;  // DisplayFrame::order of the newest frame that was handed over.

  bool is_written_to_ = false;             // Used by the stream's messages only: there was a caption.
  std::vector<HeadFootprint> footprints_;  // Footprints of the heads in use, or of those that will be used next.
  std::optional<Error> misfit_;            // Set while the newest calibration is refused.
  std::optional<Error> loss_;              // Set while there is no output.
  std::optional<Error> trouble_;           // Set while there is no connection.
  TimePoint connect_at_{};
  std::uint64_t reported_after_ = 0;  // Frames up to this DisplayFrame::order came over an earlier connection.

  // In this order, so that destruction, in reverse, keeps callbacks from reaching destroyed members.
  std::unique_ptr<WireServer> server_;
  JpegDecoder pictures_;                     // Used by serve_watchers().
  std::unique_ptr<CalibrationWatch> watch_;  // Null without a calibration's folder.
  std::unique_ptr<PresentThread> present_;
  std::unique_ptr<DecodePool> pool_;
  std::unique_ptr<FrameAssembler> assembler_;
  std::unique_ptr<ShowStream> stream_;
};

}  // namespace cyclorama::display
