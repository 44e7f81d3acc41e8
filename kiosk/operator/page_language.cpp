// SPDX-License-Identifier: Apache-2.0
#include "kiosk/operator/page_language.h"

#include <httplib.h>

#include <algorithm>
#include <array>
#include <nlohmann/json.hpp>
#include <utility>

#include "common/http/http_server.h"

namespace cyclorama::operations {
namespace {

using Json = nlohmann::ordered_json;

/// Keys whose values are texts for people. A "state" that is one word of a protocol is in no catalogue.
constexpr std::array<std::string_view, 14> kTextKeys{"sentence", "remedy",           "error",    "state",  "step",
                                                     "question", "problem",          "problems", "reason", "undone",
                                                     "why",      "override_problem", "remarks",  "line"};

bool is_text_key(std::string_view key) { return std::ranges::find(kTextKeys, key) != kTextKeys.end(); }

void translate(const Catalogue& catalogue, bool is_text, Json* json) {
  if (json->is_string()) {
    if (is_text) *json = catalogue.sentence(json->get_ref<const std::string&>());
  } else if (json->is_array()) {
    for (Json& one : *json) translate(catalogue, is_text, &one);
  } else if (json->is_object()) {
    // A stop's or a tour's title is the museum's own; a check's title is ours.
    const bool is_check = json->contains("remedy");
    for (auto& [key, value] : json->items())
      translate(catalogue, is_text_key(key) || (is_check && key == "title"), &value);
  }
}

Json languages_json() {
  Json names = Json::object();
  for (const Catalogue& one : Catalogue::all()) names[one.language()] = one.name();
  return names;
}

bool is_known(const std::string& language) { return Catalogue::of(language).language() == language; }

}  // namespace

const Catalogue& catalogue_for(const httplib::Request& request) {
  return Catalogue::of(best_language(request.get_header_value("Accept-Language")));
}

std::string in_language(const Catalogue& catalogue, std::string_view json) {
  Json document = Json::parse(json, nullptr, false);
  if (document.is_discarded()) return std::string(json);
  translate(catalogue, false, &document);
  return document.dump(1, ' ', false, Json::error_handler_t::replace);
}

void answer_json(const httplib::Request& request, const std::string& json, httplib::Response& response) {
  const Catalogue& catalogue = catalogue_for(request);
  response.set_content(catalogue.language() == "en" ? json : in_language(catalogue, json), kJsonType);
}

void serve_languages(httplib::Server& server, std::function<std::string()> museums) {
  server.Get("/texts", [museums = std::move(museums)](const httplib::Request& request, httplib::Response& response) {
    std::string language = request.has_param("language") ? request.get_param_value("language") : "";
    if (!is_known(language)) language = museums();
    if (!is_known(language)) language = best_language(request.get_header_value("Accept-Language"));
    Json json = Json::parse(Catalogue::of(language).json());
    json["languages"] = languages_json();
    response.set_content(json.dump(-1, ' ', false, Json::error_handler_t::replace), kJsonType);
  });
  server.set_error_handler([](const httplib::Request& request, httplib::Response& response) {
    explain_mistake(request, response);
    const Catalogue& catalogue = catalogue_for(request);
    if (catalogue.language() != "en") response.set_content(in_language(catalogue, response.body), kJsonType);
  });
}

}  // namespace cyclorama::operations
