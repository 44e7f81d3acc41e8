// SPDX-License-Identifier: Apache-2.0
/// The door of the operator page.
///
///   with a PIN (HTTPS):    POST /login {"pin"} ──▶ a cookie __Host-cyclorama (Secure, HttpOnly, SameSite=Strict)
///                          everything but the login page asks for it; POST /logout ends it
///                          while there is none yet, GET /door says why (door_checks.h), and so does /login
///   without (loopback):    everybody on this computer comes in, by a loopback name alone, so that no foreign name that
///                          leads here (DNS rebinding) does
///
/// Either way a request that changes something must be JSON, and from this very page if its browser says from where.
#pragma once

#include <functional>
#include <span>
#include <vector>

#include "common/http/page_file.h"
#include "kiosk/operator/checks.h"
#include "kiosk/operator/sessions.h"

namespace httplib {
class Server;
}

namespace cyclorama {

/// To be called before the other routes are added. `sessions` is borrowed; null: without a PIN. `login` are the files
/// that may be seen before the PIN: "/login.html" must be among them. `told` gives what everybody may know: nothing
/// once there is a PIN. It is called by several threads.
void guard(httplib::Server& server, Sessions* sessions, std::span<const PageFile> login,
           std::function<std::vector<Check>()> told);

}  // namespace cyclorama
