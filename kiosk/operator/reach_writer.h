// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "common/base/clock.h"
#include "common/base/result.h"
#include "common/reach/page_reach.h"
#include "kiosk/operator/museum_state.h"
#include "kiosk/operator/sessions.h"

namespace cyclorama::operations {

/// Returns this computer's addresses that others reach: IPv4 first, since most phones have that, then IPv6. Link-local
/// ones are left out, since browsers accept none.
[[nodiscard]] std::vector<std::string> outside_addresses();

/// Returns the page's address under the first of these; empty if there is none.
[[nodiscard]] std::string outside_page(int port);

/// Writes how the page is reached for the display. Thread-bound.
class ReachWriter {
 public:
  struct Options {
    std::filesystem::path file;
    int port = 0;
    std::string fingerprint;
    bool has_mdns = false;  ///< This computer answers to NAME.local.
    MuseumState museum;
  };
  /// `sessions` is borrowed; null: the page has no PIN, and the wall no code.
  ReachWriter(Options options, Sessions* sessions) : options_(std::move(options)), sessions_(sessions) {}

  /// Writes the present state. `answers`: the page has just answered itself. Errors: kSystem if the file cannot be
  /// written, or there is no code for the wall.
  Status write(bool answers, TimePoint now);

 private:
  const Options options_;
  Sessions* const sessions_;
  TimePoint code_from_{};
  PageReach reach_;
};

}  // namespace cyclorama::operations
