// SPDX-License-Identifier: Apache-2.0
/// The operator page's requests about the tour's stops.
///
///   GET  /stops   {"title", "at", "is_led", "problem", "languages", "captions", "stops": [{"name", "title", "text",
///                 "is_kept"}]}; texts in the tour's first language; "at" is null or a number in the list; "captions" is
///                 null if the tour writes nothing on the wall, else the languages that are written
///   POST /stops   {"do": "next" | "previous" | "stop-here" | "undo" | "fetch"} or {"do": "go", "name": NAME} or
///                 {"do": "captions", "languages": [TAG, ...]}; {"name"} of the stop that is gone to or added, else 204
#pragma once

#include <string>

#include "common/base/result.h"
#include "common/wire/museum.pb.h"

namespace httplib {
class Server;
}

namespace cyclorama::operations {

struct StopOrder {
  enum class Kind { kGo, kAdd, kUndo, kFetch, kCaptions };
  Kind kind = Kind::kGo;
  wire::GoToStopRequest go;           ///< For kGo.
  wire::SetCaptionsRequest captions;  ///< For kCaptions.
};

/// Parses the body of POST /stops. Errors: kBadData for any other form.
Result<StopOrder> parse_stop_order(const std::string& json);

/// `tour` is the tour's address.
void serve_stops(httplib::Server& server, const std::string& tour);

}  // namespace cyclorama::operations
