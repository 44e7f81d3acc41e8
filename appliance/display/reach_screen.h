// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <vector>

#include "appliance/display/text_font.h"
#include "common/base/clock.h"
#include "common/reach/page_reach.h"
#include "drivers/output/output.h"

namespace cyclorama::display {

/// The wall shows how to reach the operator page: until the first PIN is set, for kHelpShown after a press of Help, and
/// while the page has not been reachable for kUnreachable. Otherwise never, since visitors do not need it. `reach` is
/// nothing if the page has not run since the start. Pure.
[[nodiscard]] bool shows_reach(const std::optional<PageReach>& reach, std::optional<TimePoint> helped_at,
                               TimePoint now);
inline constexpr Duration kHelpShown = std::chrono::minutes(2);
/// While the museum has chosen no language, each is shown for this time.
inline constexpr Duration kLanguageShown = std::chrono::seconds(8);
inline constexpr Duration kUnreachable = std::chrono::hours(24);

/// Watches the files that decide this, and draws the pictures. Thread-bound.
class ReachScreen {
 public:
  using Pictures = std::vector<std::shared_ptr<const RgbaImage>>;

  /// `reach` is the file that the operator page writes (page_reach.h); `help` is one whose time changes when somebody
  /// presses Help, which cyclorama-hand writes. Either may be missing. `heads` are those of the output.
  ReachScreen(std::filesystem::path reach, std::filesystem::path help, std::vector<output::HeadMode> heads);

  /// Returns true if pictures() changed. Reads the files at most four times a second.
  bool update(TimePoint now);
  /// A picture for each head, in their order; none: the show is shown.
  [[nodiscard]] const Pictures& pictures() const { return pictures_; }
  /// The reason why nothing can be drawn; empty: none.
  [[nodiscard]] const std::string& trouble() const { return trouble_; }

 private:
  void read_files(TimePoint now);
  void draw();

  const std::filesystem::path reach_file_;
  const std::filesystem::path help_file_;
  const std::vector<output::HeadMode> heads_;
  TimePoint read_at_{};
  bool is_first_ = true;
  std::optional<std::filesystem::file_time_type> help_written_;
  std::optional<TimePoint> helped_at_;
  std::optional<PageReach> reach_;
  std::optional<PageReach> drawn_;  ///< Content of the pictures.
  std::optional<TextFont> font_;
  Pictures pictures_;
  std::string trouble_;
};

}  // namespace cyclorama::display
