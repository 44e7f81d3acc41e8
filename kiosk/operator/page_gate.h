// SPDX-License-Identifier: Apache-2.0
/// Access control of the operator page.
///
///   with a PIN (HTTPS):    POST /login {"pin", "wall"} ──▶ cookie __Host-cyclorama (Secure, HttpOnly, SameSite=Strict)
///                          required by everything but the login page; POST /logout ends it
///                          while there is no PIN yet, GET /door reports why (login_checks.h), and so does /login
///   without (loopback):    open to everybody on this computer, but only under a loopback name, so that a foreign name
///                          that resolves to it (DNS rebinding) is refused
///
/// In both cases a request that changes something must be JSON and, if the browser sends its origin, come from this
/// page.
#pragma once

#include <functional>
#include <span>
#include <string_view>
#include <vector>

#include "common/http/page_file.h"
#include "kiosk/operator/checks.h"
#include "kiosk/operator/sessions.h"

namespace httplib {
class Server;
}

namespace cyclorama::operations {

/// Guards all routes of a server. Must be called before the other routes are added. `sessions` is borrowed; null: no
/// PIN. `login` lists the files that need no PIN and must include "/login.html". `told` returns public findings:
/// nothing once there is a PIN. `admits_scraper` decides by a request's Authorization whether it may read /metrics without
/// a PIN; empty: nobody may. Several threads call both.
void guard(httplib::Server& server, Sessions* sessions, std::span<const PageFile> login,
           std::function<std::vector<Check>()> told,
           std::function<bool(std::string_view authorization)> admits_scraper = {});

}  // namespace cyclorama::operations
