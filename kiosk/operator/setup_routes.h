// SPDX-License-Identifier: Apache-2.0
/// The installer's way over HTTP.
///
///   GET  /setup            {"steps": {NAME: {"revision", "by", "at", "fields", "problems", "in_use"}}, "wall",
///                          "plugged", "cables", "network": {"state", "sentence"}, "is_checking", ...}
///   POST /setup/step       {"step", "revision", "fields"}; 200 with the step, or 409 with it as somebody else left it
///   POST /setup/use        {"step", "revision"}; {"code"}: what confirms a network that is being tried
///   POST /setup/keep       {"code"}; needs no PIN, since the page may have another address now
///   POST /setup/bring      {"step", "name", "content"}: a certificate, key or lens for that step
///   POST /setup/blink      {"projector"}
///   POST /first-pin        {"pin", "wall"}: while there is none, from somebody who sees the wall
///   GET  /setup/report.html, /setup/board.pdf, /setup/wand.pdf, /setup/sheet.pdf
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "kiosk/operator/sessions.h"
#include "kiosk/operator/setup_service.h"

namespace httplib {
class Server;
}

namespace cyclorama::operations {

/// Facts that the sheet for the office prints, besides the settings.
struct SheetFacts {
  std::string fingerprint;             ///< The fingerprint of the page's certificate.
  std::vector<std::string> addresses;  ///< Addresses of the page.
};

/// `setup` and `sessions` are borrowed; `sessions` may be null. `sheet` returns the present facts.
void serve_setup(httplib::Server& server, SetupService* setup, Sessions* sessions,
                 const std::function<SheetFacts()>& sheet);

}  // namespace cyclorama::operations
