// SPDX-License-Identifier: Apache-2.0
#include "common/language/sentence_template.h"

#include <algorithm>
#include <cctype>

namespace cyclorama {

SentenceTemplate::SentenceTemplate(std::string_view text) : texts_(1) {
  for (std::size_t at = 0; at < text.size(); ++at) {
    const char c = text[at];
    const bool is_doubled = at + 1 < text.size() && text[at + 1] == c;
    if ((c == '{' || c == '}') && is_doubled) ++at;
    const std::size_t end = c == '{' && !is_doubled ? text.find('}', at) : std::string_view::npos;
    if (end == std::string_view::npos) {
      texts_.back() += c;
      continue;
    }
    const std::string_view inner = text.substr(at + 1, end - at - 1);
    const std::string_view number = inner.substr(0, inner.find(':'));
    Place place{places_.size(), inner.find(':') != std::string_view::npos && inner.ends_with('f')};
    if (!number.empty() && std::ranges::all_of(number, [](char d) { return d >= '0' && d <= '9'; }) &&
        number.size() < 3) {
      place.argument = static_cast<std::size_t>(std::stoi(std::string(number)));
    }
    places_.push_back(place);
    texts_.emplace_back();
    at = end;
  }
}

int SentenceTemplate::letters() const {
  int count = 0;
  for (const std::string& text : texts_) {
    count += static_cast<int>(
        std::ranges::count_if(text, [](char c) { return std::isalpha(static_cast<unsigned char>(c)) != 0; }));
  }
  return count;
}

bool SentenceTemplate::is_decimal(std::size_t argument) const {
  return std::ranges::any_of(places_,
                             [&](const Place& place) { return place.argument == argument && place.is_decimal; });
}

std::optional<std::vector<std::string>> SentenceTemplate::arguments_of(std::string_view sentence) const {
  if (!sentence.starts_with(texts_.front()) || !sentence.ends_with(texts_.back())) return std::nullopt;
  std::size_t at = texts_.front().size();
  if (sentence.size() < at + texts_.back().size()) return std::nullopt;
  const std::size_t end = sentence.size() - texts_.back().size();
  std::vector<std::string> arguments;
  for (std::size_t i = 0; i < places_.size(); ++i) {
    const bool is_last = i + 1 == places_.size();
    const std::size_t next = is_last ? end : sentence.find(texts_[i + 1], at);
    if (next == std::string_view::npos || next > end) return std::nullopt;
    const std::size_t argument = places_[i].argument;
    const std::string_view value = sentence.substr(at, next - at);
    const bool is_again = std::any_of(places_.begin(), places_.begin() + static_cast<std::ptrdiff_t>(i),
                                      [&](const Place& place) { return place.argument == argument; });
    if (is_again && arguments[argument] != value) return std::nullopt;
    if (arguments.size() <= argument) arguments.resize(argument + 1);
    arguments[argument] = value;
    at = next + texts_[i + 1].size();
  }
  return places_.empty() && at != sentence.size() ? std::nullopt : std::optional(arguments);
}

std::string SentenceTemplate::filled(const std::vector<std::string>& arguments) const {
  std::string sentence = texts_.front();
  for (std::size_t i = 0; i < places_.size(); ++i) {
    if (places_[i].argument < arguments.size()) sentence += arguments[places_[i].argument];
    sentence += texts_[i + 1];
  }
  return sentence;
}

}  // namespace cyclorama
