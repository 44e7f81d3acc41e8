// SPDX-License-Identifier: Apache-2.0
#include "kiosk/operator/stop_routes.h"

#include <httplib.h>

#include <nlohmann/json.hpp>

#include "common/base/text.h"
#include "common/http/http_server.h"
#include "kiosk/operator/page_language.h"
#include "kiosk/operator/status_json.h"
#include "kiosk/operator/tour_call.h"

namespace cyclorama::operations {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::size_t kMaxTextBytes = 4000;

std::string dumped(const Json& json) { return json.dump(1, ' ', false, Json::error_handler_t::replace); }

Json list_json(const wire::StopList& list) {
  const std::string first = list.languages_size() > 0 ? list.languages(0) : "";
  const auto text_of = [&](const auto& texts) {
    const auto text = texts.find(first);
    return text == texts.end() ? std::string() : printable(text->second, kMaxTextBytes);
  };
  Json json{{"title", printable(list.tour_title(), kMaxTextBytes)},
            {"at", nullptr},
            {"is_led", list.is_led()},
            {"problem", printable(list.problem(), kMaxTextBytes)},
            {"languages", Json::array()},
            {"captions", nullptr},
            {"stops", Json::array()}};
  for (const std::string& language : list.languages()) json["languages"].push_back(printable(language));
  if (list.has_captions()) {
    json["captions"] = Json::array();
    for (const std::string& language : list.caption_languages()) json["captions"].push_back(printable(language));
  }
  if (list.has_at()) json["at"] = list.at();
  for (const wire::StopSummary& stop : list.stops()) {
    json["stops"].push_back({{"name", printable(stop.name())},
                             {"title", text_of(stop.titles())},
                             {"text", text_of(stop.texts())},
                             {"is_kept", stop.is_kept()}});
  }
  return json;
}

/// Carries the order out. Returns the name of the stop that is gone to or added, or an empty text.
Result<std::string> carry_out(const std::string& tour, const StopOrder& order) {
  switch (order.kind) {
    case StopOrder::Kind::kGo: {
      TRY_ASSIGN(const wire::GoToStopReply reply,
                 (call_tour<wire::GoToStopReply>(tour, "going to the stop", order.go, &wire::Tour::Stub::GoToStop)));
      return reply.name();
    }
    case StopOrder::Kind::kAdd: {
      TRY_ASSIGN(
          const wire::AddStopReply reply,
          (call_tour<wire::AddStopReply>(tour, "adding a stop", wire::AddStopRequest(), &wire::Tour::Stub::AddStop)));
      return reply.name();
    }
    case StopOrder::Kind::kUndo:
      TRY(call_tour<wire::UndoStopReply>(tour, "undoing", wire::UndoStopRequest(), &wire::Tour::Stub::UndoStop));
      return std::string();
    case StopOrder::Kind::kCaptions:
      TRY(call_tour<wire::SetCaptionsReply>(tour, "choosing captions", order.captions, &wire::Tour::Stub::SetCaptions));
      return std::string();
    case StopOrder::Kind::kFetch:
      TRY(call_tour<wire::FetchPicturesReply>(tour, "fetching pictures", wire::FetchPicturesRequest(),
                                              &wire::Tour::Stub::FetchPictures));
  }
  return std::string();
}

/// Reads a list of languages' tags. Returns false if there is none.
bool read_languages(const Json& json, wire::SetCaptionsRequest* ret_request) {
  const auto list = json.find("languages");
  if (list == json.end() || !list->is_array()) return false;
  for (const Json& tag : *list) {
    if (!tag.is_string()) return false;
    ret_request->add_languages(printable(tag.get<std::string>()));
  }
  return true;
}

}  // namespace

Result<StopOrder> parse_stop_order(const std::string& text) {
  const Json json = Json::parse(text, nullptr, false);
  const auto word = [&](const char* key) {
    return json.is_object() && json.contains(key) && json[key].is_string() ? json[key].get<std::string>() : "";
  };
  const std::string wanted = word("do");
  StopOrder order;
  if (wanted == "next" || wanted == "previous") {
    order.go.set_step(wanted == "next" ? 1 : -1);
  } else if (wanted == "go" && !word("name").empty()) {
    order.go.set_name(printable(word("name")));
  } else if (wanted == "stop-here") {
    order.kind = StopOrder::Kind::kAdd;
  } else if (wanted == "undo") {
    order.kind = StopOrder::Kind::kUndo;
  } else if (wanted == "captions" && read_languages(json, &order.captions)) {
    order.kind = StopOrder::Kind::kCaptions;
  } else if (wanted == "fetch") {
    order.kind = StopOrder::Kind::kFetch;
  } else {
    return Error(ErrorCode::kBadData,
                 "'do' must be next, previous, stop-here, undo, fetch, go with a 'name', or captions with 'languages'");
  }
  return order;
}

void serve_stops(httplib::Server& server, const std::string& tour) {
  server.Get("/stops", [tour](const httplib::Request& request, httplib::Response& response) {
    const auto list =
        call_tour<wire::StopList>(tour, "listing the stops", wire::ListStopsRequest(), &wire::Tour::Stub::ListStops);
    if (!list) return answer_error(list.error(), response);
    answer_json(request, dumped(list_json(*list)), response);
  });
  server.Post("/stops", [tour](const httplib::Request& request, httplib::Response& response) {
    const auto order = parse_stop_order(request.body);
    if (!order) return answer_error(order.error(), response);
    const auto name = carry_out(tour, *order);
    if (!name) return answer_error(name.error(), response);
    response.status = 204;
    if (name->empty()) return;
    response.status = 200;
    response.set_content(dumped({{"name", printable(*name)}}), kJsonType);
  });
}

}  // namespace cyclorama::operations
