// SPDX-License-Identifier: Apache-2.0
#include "common/language/catalogue.h"

#include <algorithm>
#include <cctype>
#include <charconv>
#include <nlohmann/json.hpp>
#include <optional>
#include <utility>

#include "common/base/check.h"
#include "common/language/catalogues.h"

namespace cyclorama {
namespace {

constexpr std::string_view kEnglish =
    R"({"language": "en", "name": "English", "decimal": ".", "stop": ".", "space": " ", "plural": "10", "texts": []})";
constexpr int kMaxDepth = 4;
/// A template with fewer letters, such as "{}: {}", would match nearly everything.
constexpr int kMinLetters = 4;
constexpr std::size_t kMaxSentence = 2048;  // Longer ones are a peer's, and none of ours.

bool is_decimal_number(std::string_view text) {
  const std::size_t point = text.find('.');
  return point != std::string_view::npos && point > 0 && point + 1 < text.size() &&
         std::ranges::all_of(text, [](char c) { return (c >= '0' && c <= '9') || c == '.' || c == '-'; }) &&
         text.find('.', point + 1) == std::string_view::npos;
}

std::optional<std::size_t> whole_number(std::string_view text) {
  std::size_t number = 0;
  const auto [end, failed] = std::from_chars(text.data(), text.data() + text.size(), number);
  if (failed != std::errc() || end != text.data() + text.size()) return std::nullopt;
  return number;
}

}  // namespace

Catalogue::Catalogue(std::string_view json) : json_(json) {
  const nlohmann::json document = nlohmann::json::parse(json, nullptr, false);
  CHECK(document.is_object());  // This program's own, checked when it was built.
  language_ = document["language"].get<std::string>();
  name_ = document["name"].get<std::string>();
  decimal_ = document["decimal"].get<std::string>();
  stop_ = document["stop"].get<std::string>();
  space_ = document["space"].get<std::string>();
  plural_ = document["plural"].get<std::string>();
  for (const nlohmann::json& text : document["texts"]) {
    const auto one = text[0].get<std::string>();
    const auto many = text[1].get<std::string>();
    Entry entry{SentenceTemplate(one), {}, !many.empty()};
    for (std::size_t i = 2; i < text.size(); ++i) entry.forms.emplace_back(text[i].get<std::string>());
    add(one, entry);
    if (many.empty()) continue;
    entry.english = SentenceTemplate(many);
    add(many, entry);
  }
  std::ranges::stable_sort(templates_, std::greater<>(), [](const Entry& entry) { return entry.english.letters(); });
}

void Catalogue::add(const std::string& english, const Entry& entry) {
  if (!entry.english.has_arguments()) {
    whole_.emplace(english, entry);
  } else if (entry.english.letters() >= kMinLetters) {
    templates_.push_back(entry);
  }
}

const std::vector<Catalogue>& Catalogue::all() {
  static const std::vector<Catalogue> kAll = [] {
    std::vector<Catalogue> all{Catalogue(kEnglish)};
    for (const std::string_view json : embedded_catalogues()) all.push_back(Catalogue(json));
    return all;
  }();
  return kAll;
}

const Catalogue& Catalogue::of(std::string_view language) {
  const auto& known = all();
  const auto found = std::ranges::find(known, language, &Catalogue::language_);
  return found == known.end() ? known.front() : *found;
}

std::string Catalogue::sentence(std::string_view english, int depth) const {
  if (depth > kMaxDepth || english.empty() || english.size() > kMaxSentence || (whole_.empty() && templates_.empty()))
    return std::string(english);
  std::string text;
  // An argument across sentences is possible, such as another program's error, but a template for each sentence is likelier.
  if (translate_whole(english, Arguments::kWithinASentence, depth, &text) ||
      translate_sentences(english, depth, &text) || translate_whole(english, Arguments::kAny, depth, &text) ||
      translate_parts(english, depth, &text)) {
    return text;
  }
  return std::string(english);
}

bool Catalogue::translate_whole(std::string_view english, Arguments allowed, int depth, std::string* ret_text) const {
  if (const auto found = whole_.find(english); found != whole_.end()) {
    *ret_text = found->second.forms.front().filled({});
    return true;
  }
  for (const Entry& entry : templates_) {
    auto arguments = entry.english.arguments_of(english);
    if (!arguments) continue;
    const auto has_end = [](const std::string& argument) { return argument.find(". ") != std::string::npos; };
    if (allowed == Arguments::kWithinASentence && std::ranges::any_of(*arguments, has_end)) continue;
    *ret_text = fill(entry, *std::move(arguments), depth);
    return true;
  }
  return false;
}

std::string Catalogue::fill(const Entry& entry, std::vector<std::string> arguments, int depth) const {
  std::size_t form = 0;
  if (entry.has_plural) {
    std::optional<std::size_t> found;
    for (std::size_t i = 0; i < arguments.size() && !found; ++i) found = whole_number(arguments[i]);
    const std::size_t count = found.value_or(2);
    const std::size_t rule = count < plural_.size() ? count : plural_.size() - 100 + count % 100;
    form = static_cast<std::size_t>(plural_[rule] - '0');
  }
  for (std::size_t i = 0; i < arguments.size(); ++i) {
    std::string& argument = arguments[i];
    if (entry.english.is_decimal(i) && is_decimal_number(argument)) {
      argument.replace(argument.find('.'), 1, decimal_);
    } else {
      argument = sentence(argument, depth + 1);
    }
  }
  return entry.forms[std::min(form, entry.forms.size() - 1)].filled(arguments);
}

bool Catalogue::translate_sentences(std::string_view english, int depth, std::string* ret_text) const {
  // The longest known beginning comes first, since texts of several sentences are in the catalogue as a whole.
  for (std::size_t end = english.rfind(". "); end != std::string_view::npos && end > 0;
       end = english.rfind(". ", end - 1)) {
    std::string begin;
    if (!translate_whole(english.substr(0, end + 1), Arguments::kWithinASentence, depth, &begin)) continue;
    *ret_text = begin + space_ + sentence(english.substr(end + 2), depth + 1);
    return true;
  }
  const std::size_t first = english.find(". ");
  if (first == std::string_view::npos) return false;
  const std::string_view rest = english.substr(first + 2);
  const std::string translated = sentence(rest, depth + 1);
  if (translated == rest) return false;
  *ret_text = sentence(english.substr(0, first + 1), depth + 1) + space_ + translated;
  return true;
}

bool Catalogue::translate_parts(std::string_view english, int depth, std::string* ret_text) const {
  if (english.ends_with('.') &&
      translate_whole(english.substr(0, english.size() - 1), Arguments::kAny, depth, ret_text)) {
    *ret_text += stop_;
    return true;
  }
  for (const std::string_view between : {std::string_view("; "), std::string_view(": "), std::string_view(", ")}) {
    const std::size_t at = english.find(between);
    if (at == std::string_view::npos) continue;
    const std::string_view rest = english.substr(at + between.size());
    std::string begin;
    // A text may end with its colon: "It does not answer:".
    if (translate_whole(english.substr(0, at + 1), Arguments::kAny, depth, &begin)) {
      *ret_text = begin + " " + sentence(rest, depth + 1);
      return true;
    }
    begin = sentence(english.substr(0, at), depth + 1);
    const std::string end = sentence(rest, depth + 1);
    const bool has_begin = begin != english.substr(0, at);
    const bool has_end = end != rest;
    // Commas also stand within sentences, so both sides must be known.
    if (between == ", " ? !has_begin || !has_end : !has_begin && !has_end) continue;
    *ret_text = begin.append(between).append(end);
    return true;
  }
  return false;
}

std::string best_language(std::string_view accepted) {
  std::string best;
  double best_quality = 0.0;
  while (!accepted.empty()) {
    const std::size_t end = std::min(accepted.find(','), accepted.size());
    std::string_view one = accepted.substr(0, end);
    accepted.remove_prefix(std::min(end + 1, accepted.size()));
    while (one.starts_with(' ')) one.remove_prefix(1);
    double quality = 1.0;
    if (const std::size_t at = one.find(";q="); at != std::string_view::npos) {
      quality = 0.0;
      std::from_chars(one.data() + at + 3, one.data() + one.size(), quality);
    }
    std::string language;
    for (const char c : one.substr(0, one.find_first_of("-;"))) {
      language += static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
    }
    if (quality <= best_quality || Catalogue::of(language).language() != language) continue;
    best = language;
    best_quality = quality;
  }
  return best;
}

}  // namespace cyclorama
