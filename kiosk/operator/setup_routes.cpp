// SPDX-License-Identifier: Apache-2.0
#include "kiosk/operator/setup_routes.h"

#include <httplib.h>

// httplib.h includes resolv.h, whose macro breaks what Eigen, in the sheets' headers, calls by this name.
#undef _res

#include <nlohmann/json.hpp>
#include <optional>
#include <utility>

#include "common/base/text.h"
#include "common/http/http_server.h"
#include "kiosk/operator/board_sheet.h"
#include "kiosk/operator/setup_sheet.h"
#include "kiosk/operator/wand_sheet.h"

namespace cyclorama::operations {
namespace {

using Json = nlohmann::ordered_json;

constexpr const char* kPdfType = "application/pdf";

/// Returns a text of a JSON object; empty if it has none.
std::string word(const Json& json, const char* key) {
  return json.is_object() && json.contains(key) && json[key].is_string() ? json[key].get<std::string>() : "";
}

int revision_in(const Json& json) {
  return json.is_object() && json.contains("revision") && json["revision"].is_number_integer()
             ? json["revision"].get<int>()
             : -1;
}

std::optional<setup::Fields> fields_in(const Json& json) {
  if (!json.is_object() || !json.contains("fields") || !json["fields"].is_object()) return std::nullopt;
  setup::Fields fields;
  for (const auto& [name, value] : json["fields"].items()) {
    if (!value.is_string()) return std::nullopt;
    fields[name] = value.get<std::string>();
  }
  return fields;
}

void answer(const Status& done, httplib::Response& response) {
  if (!done) return answer_error(done.error(), response);
  response.status = 204;
}

void serve_steps(httplib::Server& server, SetupService* setup) {
  server.Get("/setup", [setup](const httplib::Request&, httplib::Response& response) {
    response.set_content(setup->json(), kJsonType);
  });
  server.Post("/setup/step", [setup](const httplib::Request& request, httplib::Response& response) {
    const Json json = Json::parse(request.body, nullptr, false);
    auto fields = fields_in(json);
    if (!fields || revision_in(json) < 0) {
      return answer_error(Error(ErrorCode::kBadData, "send {\"step\", \"revision\", \"fields\": {NAME: TEXT}}"),
                          response);
    }
    const std::string step = word(json, "step");
    const auto saved = setup->save({step, revision_in(json), *std::move(fields)}, request.remote_addr);
    if (!saved && saved.error().code() != ErrorCode::kBusy) return answer_error(saved.error(), response);
    response.status = saved ? 200 : 409;
    response.set_content(setup->step_json(step), kJsonType);
  });
  server.Post("/setup/use", [setup](const httplib::Request& request, httplib::Response& response) {
    const Json json = Json::parse(request.body, nullptr, false);
    const auto code = setup->use(word(json, "step"), revision_in(json));
    if (!code) return answer_error(code.error(), response);
    response.set_content(Json{{"code", *code}}.dump(), kJsonType);
  });
  server.Post("/setup/keep", [setup](const httplib::Request& request, httplib::Response& response) {
    answer(setup->keep_network(word(Json::parse(request.body, nullptr, false), "code")), response);
  });
  server.Post("/setup/bring", [setup](const httplib::Request& request, httplib::Response& response) {
    const Json json = Json::parse(request.body, nullptr, false);
    answer(setup->bring(word(json, "step"), word(json, "name"), word(json, "content")), response);
  });
  server.Post("/setup/blink", [setup](const httplib::Request& request, httplib::Response& response) {
    answer(setup->blink(word(Json::parse(request.body, nullptr, false), "projector")), response);
  });
}

void serve_papers(httplib::Server& server, SetupService* setup, const std::function<SheetFacts()>& sheet) {
  server.Get(R"(/setup/(board|wand)\.pdf)", [](const httplib::Request& request, httplib::Response& response) {
    const Paper& paper = papers().front();
    response.set_content(to_pdf(request.matches[1].str() == "board" ? board_sheet(paper) : wand_sheet(0, paper)),
                         kPdfType);
  });
  server.Get("/setup/sheet.pdf", [setup, sheet](const httplib::Request&, httplib::Response& response) {
    response.set_content(to_pdf({setup_sheet(setup->place().museum, sheet())}), kPdfType);
  });
  server.Get("/setup/report.html", [setup](const httplib::Request&, httplib::Response& response) {
    const auto report = setup->report();
    if (!report) return answer_error(report.error(), response);
    // One file with its own styles and pictures, and nothing that runs.
    response.headers.erase("Content-Security-Policy");
    response.set_header(
        "Content-Security-Policy",
        "default-src 'none'; style-src 'unsafe-inline'; img-src data:; frame-ancestors 'none'; sandbox");
    response.set_content(*report, "text/html; charset=utf-8");
  });
}

}  // namespace

void serve_setup(httplib::Server& server, SetupService* setup, Sessions* sessions,
                 const std::function<SheetFacts()>& sheet) {
  server.Get("/install",
             [](const httplib::Request&, httplib::Response& response) { response.set_redirect("/install.html", 303); });
  serve_steps(server, setup);
  serve_papers(server, setup, sheet);
  if (sessions == nullptr) return;
  server.Post("/first-pin", [setup, sessions](const httplib::Request& request, httplib::Response& response) {
    const Json json = Json::parse(request.body, nullptr, false);
    if (!sessions->is_wall_code(word(json, "wall"))) {
      return answer_error(Error(ErrorCode::kInvalidArgument,
                                "scan the code on the wall again; only who sees it may choose the first PIN"),
                          response);
    }
    answer(setup->offer_first_pin(word(json, "pin")), response);
  });
}

}  // namespace cyclorama::operations
