// SPDX-License-Identifier: Apache-2.0
/// The language of the operator page's answers.
///
///   GET /texts?language=de    the catalogue for the page's scripts (common/http/page/texts.js); needs no PIN
///
/// The language is the one that the reader chose on the page, else the museum's (care.toml), else the browser's. The
/// page's scripts send it with each request as Accept-Language, and what the museum's programs report in English is
/// translated in the answer.
#pragma once

#include <functional>
#include <string>
#include <string_view>

#include "common/language/catalogue.h"

namespace httplib {
class Server;
struct Request;
struct Response;
}  // namespace httplib

namespace cyclorama::operations {

/// Returns the catalogue that a request's Accept-Language prefers; English if there is none.
[[nodiscard]] const Catalogue& catalogue_for(const httplib::Request& request);

/// Translates in a JSON text the values that people read: sentence, remedy, error and others of kTextKeys, and the titles
/// of checks. What is no JSON stays as it is.
[[nodiscard]] std::string in_language(const Catalogue& catalogue, std::string_view json);

/// Answers with JSON in the request's language.
void answer_json(const httplib::Request& request, const std::string& json, httplib::Response& response);

/// Adds GET /texts, and translates the sentences of errors. `museums` returns the museum's language, or nothing; several
/// threads call it.
void serve_languages(httplib::Server& server, std::function<std::string()> museums);

}  // namespace cyclorama::operations
