// SPDX-License-Identifier: Apache-2.0
/// Sentences in JSON that one of our programs writes for another. Included only by .cpp files.
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace cyclorama::provision {

/// Returns false if the value of `key` is not a text, is too long, or has characters that no terminal should see.
bool read_sentence(const nlohmann::ordered_json& json, const char* key, std::string* ret);
/// The same for an array, which may have a hundred texts.
bool read_sentences(const nlohmann::ordered_json& json, const char* key, std::vector<std::string>* ret);
/// Shortens sentences, and their number, so that read_sentences() takes them.
[[nodiscard]] std::vector<std::string> bounded_sentences(const std::vector<std::string>& sentences);

}  // namespace cyclorama::provision
