// SPDX-License-Identifier: Apache-2.0
#include "kiosk/operator/setup_sheet.h"

#include <fmt/format.h>

#include <algorithm>
#include <ctime>
#include <string>
#include <utility>

#include "common/base/text.h"
#include "common/config/config.h"
#include "common/room/installation.h"
#include "kiosk/provision/provisioning_report.h"

namespace cyclorama::operations {
namespace {

constexpr double kWidth_mm = 210.0;
constexpr double kHeight_mm = 297.0;
constexpr double kLeft_mm = 25.0;
constexpr double kRight_mm = 190.0;

/// Writes from the top of the page to its end.
class Sheet {
 public:
  void title(std::string_view words) {
    page_.text({kLeft_mm, y_}, 12.0, words);
    y_ += 14.0;
  }
  void heading(std::string_view words) {
    y_ += 5.0;
    page_.text({kLeft_mm, y_}, 7.0, words);
    page_.line({{kLeft_mm, y_ + 2.0}, {kRight_mm, y_ + 2.0}}, 0.2);
    y_ += 9.0;
  }
  void line(std::string_view words) {
    page_.text({kLeft_mm, y_}, 5.0, words);
    y_ += 6.5;
  }
  /// A line to write on by hand.
  void blank(std::string_view words) {
    y_ += 3.0;
    page_.text({kLeft_mm, y_}, 5.0, words);
    page_.line({{kLeft_mm + 55.0, y_}, {kRight_mm, y_}}, 0.2);
    y_ += 8.0;
  }
  VectorPage page() && { return std::move(page_); }

 private:
  VectorPage page_{kWidth_mm, kHeight_mm};
  double y_ = 28.0;
};

void add_farm(const MuseumState& museum, Sheet* sheet) {
  for (const std::string& coordinator : farm_of(museum)) sheet->line("Farm: " + printable(coordinator, 80));
}

void add_projectors(const MuseumState& museum, Sheet* sheet) {
  const auto room = read_installation(museum.settings() / "installation.toml");
  if (!room) return;
  for (const InstalledProjector& projector : room->projectors) {
    const std::string plug = projector.plug.connector.empty() ? projector.plug.serial : projector.plug.connector;
    sheet->line(fmt::format("{}: {}, {} x {} pixels{}", printable(projector.name), printable(plug),
                            projector.lens.width_px, projector.lens.height_px,
                            projector.pjlink ? ", switched at " + printable(projector.pjlink->address.host) : ""));
  }
}

}  // namespace

VectorPage setup_sheet(const MuseumState& museum, const SheetFacts& facts) {
  Sheet sheet;
  std::string name;
  if (auto config = Config::read(museum.site())) name = config->root().table("farm").text("museum", "");
  sheet.title(fmt::format("Cyclorama: {}", name.empty() ? "this installation" : printable(name, 60)));
  sheet.line(
      fmt::format("Version {}, printed {}", CYCLORAMA_VERSION, provision::time_text(std::time(nullptr)).substr(0, 10)));
  sheet.heading("The operator's page");
  for (const std::string& address : facts.addresses) sheet.line(printable(address, 80));
  sheet.line("Or press Help or F1 on a keyboard of the computer, and scan the code on the wall.");
  const std::string& print = facts.fingerprint;
  if (!print.empty()) {
    sheet.line("SHA-256 fingerprint of its certificate, to compare with what the browser shows:");
    const std::size_t half = print.size() / 2 + 1;
    sheet.line(print.substr(0, half));
    sheet.line(print.substr(std::min(half, print.size())));
  }
  sheet.heading("Projectors, from left to right");
  add_projectors(museum, &sheet);
  sheet.heading("Farm");
  add_farm(museum, &sheet);
  sheet.heading("By hand, and kept where the museum keeps its keys");
  sheet.blank("PIN of the page");
  sheet.blank("Recovery key");
  sheet.blank("Installed by");
  sheet.blank("Call in case of need");
  return std::move(sheet).page();
}

}  // namespace cyclorama::operations
