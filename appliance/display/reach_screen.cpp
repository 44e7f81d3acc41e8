// SPDX-License-Identifier: Apache-2.0
#include "appliance/display/reach_screen.h"

#include <map>
#include <system_error>
#include <utility>

#include "appliance/display/reach_picture.h"
#include "common/base/file.h"
#include "common/language/catalogue.h"

namespace cyclorama::display {
namespace {

constexpr Duration kReadEvery = std::chrono::milliseconds(250);
constexpr std::size_t kMaxFileBytes = std::size_t{64} * 1024;

/// Before a museum has chosen its language, each is shown in turn.
std::string language_at(TimePoint now) {
  const auto& all = Catalogue::all();
  return all[static_cast<std::size_t>(now.time_since_epoch() / kLanguageShown) % all.size()].language();
}

}  // namespace

bool shows_reach(const std::optional<PageReach>& reach, std::optional<TimePoint> helped_at, TimePoint now) {
  if (helped_at && now - *helped_at < kHelpShown) return true;
  if (reach && !reach->has_pin) return true;
  return now - (reach ? reach->answered_at : TimePoint{}) >= kUnreachable;
}

ReachScreen::ReachScreen(std::filesystem::path reach, std::filesystem::path help, std::vector<output::HeadMode> heads)
    : reach_file_(std::move(reach)), help_file_(std::move(help)), heads_(std::move(heads)) {}

bool ReachScreen::update(TimePoint now) {
  if (!is_first_ && now - read_at_ < kReadEvery) return false;
  read_at_ = now;
  read_files(now);
  is_first_ = false;
  std::optional<PageReach> wanted;
  if (shows_reach(reach_, helped_at_, now)) {
    wanted = reach_.value_or(PageReach{});
    if (wanted->language.empty()) wanted->language = language_at(now);
    wanted->answered_at = {};  // It is not shown, and would make a new picture each time.
  }
  if (wanted == drawn_) return false;
  drawn_ = std::move(wanted);
  draw();
  return true;
}

void ReachScreen::read_files(TimePoint now) {
  // A file that is damaged, or written by another version, is as good as none; the operator page writes it again.
  if (const auto text = read_text_file(reach_file_, kMaxFileBytes)) {
    if (auto reach = parse_page_reach(*text, reach_file_.string())) reach_ = *std::move(reach);
  }
  std::error_code missing;
  const auto written = std::filesystem::last_write_time(help_file_, missing);
  if (missing || written == help_written_) return;
  // A press before this program started is over.
  if (!is_first_) helped_at_ = now;
  help_written_ = written;
}

void ReachScreen::draw() {
  pictures_.clear();
  trouble_.clear();
  if (!drawn_) return;
  if (!font_) {
    auto font = TextFont::open_installed();
    if (!font) {
      trouble_ = font.error().message();
      return;
    }
    font_ = *std::move(font);
  }
  std::map<std::pair<int, int>, std::shared_ptr<const RgbaImage>> by_size;
  for (const output::HeadMode& head : heads_) {
    std::shared_ptr<const RgbaImage>& picture = by_size[{head.width_px, head.height_px}];
    if (picture == nullptr) {
      auto drawn = reach_picture(*drawn_, *font_, head.width_px, head.height_px);
      if (!drawn) {
        trouble_ = drawn.error().message();
        pictures_.clear();
        return;
      }
      picture = std::make_shared<const RgbaImage>(*std::move(drawn));
    }
    pictures_.push_back(picture);
  }
}

}  // namespace cyclorama::display
