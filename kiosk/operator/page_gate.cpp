// SPDX-License-Identifier: Apache-2.0
#include "kiosk/operator/page_gate.h"

#include <fmt/format.h>
#include <httplib.h>

#include <algorithm>
#include <array>
#include <nlohmann/json.hpp>
#include <string>
#include <utility>

#include "common/http/http_server.h"
#include "kiosk/operator/page_language.h"

namespace cyclorama::operations {
namespace {

constexpr std::string_view kSessionCookie = "__Host-cyclorama=";
/// Outlives sessions: it lets a device try PINs while others' wrong PINs are refused unread.
constexpr std::string_view kDeviceCookie = "__Host-cyclorama-device=";
/// They check a proof of their own: a PIN, the wall's code, a trial's code.
constexpr std::array<std::string_view, 3> kOpenRequests{"/login", "/first-pin", "/setup/keep"};
constexpr std::string_view kCookieRules = "; Path=/; Secure; HttpOnly; SameSite=Strict";
constexpr int kDeviceCookieMaxAge_s = 400 * 86400;  // Browsers keep no cookie longer.

void refuse(int status, const std::string& why, httplib::Response& response) {
  response.status = status;
  response.set_content(error_json(Error(ErrorCode::kBadData, why)), kJsonType);
}

/// Returns the value of a cookie; empty if there is none.
std::string cookie_in(const httplib::Request& request, std::string_view name) {
  const std::string cookies = request.get_header_value("Cookie");
  for (std::size_t at = 0; at < cookies.size();) {
    const std::size_t end = std::min(cookies.find(';', at), cookies.size());
    std::string_view one = std::string_view(cookies).substr(at, end - at);
    while (one.starts_with(' ')) one.remove_prefix(1);
    if (one.starts_with(name)) return std::string(one.substr(name.size()));
    at = end + 1;
  }
  return "";
}

bool is_loopback_host(const std::string& host) {
  for (const std::string_view name : {"localhost", "127.0.0.1", "[::1]", "::1"}) {
    if (host == name || (host.starts_with(name) && host[name.size()] == ':')) return true;
  }
  return false;
}

/// True unless the request names another origin. Another page in the same browser can post, but it can neither hide its
/// origin nor send the type JSON.
bool is_from_this_page(const httplib::Request& request) {
  const std::string site = request.get_header_value("Sec-Fetch-Site");
  if (!site.empty() && site != "same-origin" && site != "none") return false;
  const std::string origin = request.get_header_value("Origin");
  if (origin.empty()) return true;
  const std::string host = request.get_header_value("Host");
  return origin == "https://" + host || origin == "http://" + host;
}

bool is_json(const httplib::Request& request) {
  return request.get_header_value("Content-Type").starts_with(kJsonType);
}

/// Returns true when the request may proceed.
bool lets_pass(const httplib::Request& request, Sessions* sessions, std::span<const PageFile> login,
               const std::function<bool(std::string_view)>& admits_scraper, httplib::Response& response) {
  const bool changes = request.method != "GET" && request.method != "HEAD";
  if (changes && !is_json(request)) {
    refuse(415, "send application/json", response);
    return false;
  }
  if (changes && !is_from_this_page(request)) {
    refuse(403, "only the operator page itself may ask for that", response);
    return false;
  }
  if (sessions == nullptr) {
    if (is_loopback_host(request.get_header_value("Host"))) return true;
    refuse(421, "without a PIN this page answers only to localhost", response);
    return false;
  }
  const bool is_open_to_all =
      (request.method == "POST" && std::ranges::find(kOpenRequests, request.path) != kOpenRequests.end()) ||
      (!changes && (request.path == "/door" || request.path == "/texts")) ||
      (!changes &&
       std::any_of(login.begin(), login.end(), [&](const PageFile& file) { return file.path == request.path; }));
  const bool is_scraper = !changes && request.path == "/metrics" && admits_scraper &&
                          admits_scraper(request.get_header_value("Authorization"));
  if (is_open_to_all || is_scraper || sessions->is_open(cookie_in(request, kSessionCookie))) return true;
  if (request.method == "GET" &&
      (request.path == "/" || request.path == "/install" || request.path == "/install.html")) {
    response.set_redirect(request.path == "/" ? "/login.html" : "/login.html#next=install", 303);
  } else {
    refuse(401, "enter the PIN", response);
  }
  return false;
}

std::string sentences_of(const std::vector<Check>& checks) {
  std::string text;
  for (const Check& check : checks) {
    text += fmt::format("{}{}: {}", text.empty() ? "" : " ", check.title, check.sentence);
    if (!check.remedy.empty()) text += " " + check.remedy;
  }
  return text;
}

void serve_login(httplib::Server& server, Sessions* sessions, std::function<std::vector<Check>()> told) {
  server.Get("/door", [told](const httplib::Request& request, httplib::Response& response) {
    response.set_header("Cache-Control", "no-store");
    answer_json(request, fmt::format("{{\"checks\": {}}}", checks_json(told())), response);
  });
  server.Post("/login", [sessions, told](const httplib::Request& request, httplib::Response& response) {
    const nlohmann::json json = nlohmann::json::parse(request.body, nullptr, false);
    const auto pin = json.is_object() ? json.find("pin") : json.end();
    const std::string wall_code = json.is_object() && json.contains("wall") && json["wall"].is_string()
                                      ? json["wall"].get<std::string>()
                                      : std::string();
    if (!json.is_object() || pin == json.end() || !pin->is_string()) {
      return refuse(400, "send {\"pin\": \"...\"}", response);
    }
    const std::string device = cookie_in(request, kDeviceCookie);
    const auto login = sessions->open(pin->get_ref<const std::string&>(), request.remote_addr, {device, wall_code});
    if (!login) {
      if (login.error().code() == ErrorCode::kInvalidArgument) return refuse(403, login.error().message(), response);
      if (login.error().code() != ErrorCode::kNotFound) return answer_error(login.error(), response);
      const std::string why = sentences_of(told());
      return answer_error(why.empty() ? login.error() : Error(ErrorCode::kNotFound, why), response);
    }
    response.set_header("Set-Cookie", fmt::format("{}{}{}", kSessionCookie, login->session, kCookieRules));
    response.set_header("Set-Cookie", fmt::format("{}{}{}; Max-Age={}", kDeviceCookie, login->device, kCookieRules,
                                                  kDeviceCookieMaxAge_s));
    response.status = 204;
  });
  server.Post("/logout", [sessions](const httplib::Request& request, httplib::Response& response) {
    sessions->close(cookie_in(request, kSessionCookie));
    response.set_header("Set-Cookie", fmt::format("{}{}; Max-Age=0", kSessionCookie, kCookieRules));
    response.status = 204;
  });
}

}  // namespace

void guard(httplib::Server& server, Sessions* sessions, std::span<const PageFile> login,
           std::function<std::vector<Check>()> told, std::function<bool(std::string_view)> admits_scraper) {
  server.set_pre_routing_handler([sessions, login, admits_scraper = std::move(admits_scraper)](
                                     const httplib::Request& request, httplib::Response& response) {
    return lets_pass(request, sessions, login, admits_scraper, response) ? httplib::Server::HandlerResponse::Unhandled
                                                                         : httplib::Server::HandlerResponse::Handled;
  });
  if (sessions == nullptr) return;
  serve_page(server, login);
  serve_login(server, sessions, std::move(told));
}

}  // namespace cyclorama::operations
