// SPDX-License-Identifier: Apache-2.0
#include "common/json/strict_json.h"

#include <fmt/format.h>

#include <algorithm>

#include "common/base/text.h"

namespace cyclorama {
namespace {

constexpr std::size_t kMaxMessage = 400;
constexpr std::size_t kMaxKey = 60;

const nlohmann::json& none() {
  static const nlohmann::json json;
  return json;
}

}  // namespace

Status StrictJson::Mistakes::status(const std::string& name) const {
  if (!is_any) return Done{};
  return Error(ErrorCode::kBadData, fmt::format("{}: {}", name, printable(first, kMaxMessage)));
}

StrictJson StrictJson::at(const char* key) {
  requested_.emplace_back(key);
  if (has(key)) return {(*value_)[key], path_ + "/" + key, mistakes_};
  refuse_with_remedy(fmt::format("'{}' is missing", key));
  return {none(), path_ + "/" + key, mistakes_};
}

bool StrictJson::flag(const char* key) {
  const StrictJson value = at(key);
  if (value.value_->is_boolean()) return value.value_->get<bool>();
  value.refuse_with_remedy("is not true or false");
  return false;
}

void StrictJson::require_version(int version) {
  const StrictJson value = at("version");
  if (*value.value_ == version || !has("version")) return;
  value.refuse_with_remedy(fmt::format("is {}, and this program reads version {}", value.value_->dump(), version));
}

std::vector<StrictJson> StrictJson::elements(std::size_t min, std::size_t max) const {
  if (!value_->is_array() || value_->size() < min || value_->size() > max) {
    refuse_with_remedy(fmt::format("is not a list of {} to {}", min, max));
    return {};
  }
  std::vector<StrictJson> elements;
  for (std::size_t i = 0; i < value_->size(); ++i) {
    elements.push_back({(*value_)[i], path_ + "/" + std::to_string(i), mistakes_});
  }
  return elements;
}

std::vector<double> StrictJson::numbers(const char* key, std::size_t min, std::size_t max) {
  std::vector<double> numbers;
  for (const StrictJson& element : list(key, min, max)) numbers.push_back(element.as_number(-1e9, 1e9));
  return numbers;
}

double StrictJson::as_number(double min, double max, bool is_whole) const {
  if (value_->is_number() && (!is_whole || value_->is_number_integer())) {
    const double number = value_->get<double>();
    if (number >= min && number <= max) return number;
  }
  refuse_with_remedy(fmt::format("is not a{} number from {:f} to {:f}", is_whole ? " whole" : "", min, max));
  return min;
}

std::string StrictJson::as_text(std::size_t longest) const {
  if (value_->is_string() && value_->get_ref<const std::string&>().size() <= longest) return value_->get<std::string>();
  refuse_with_remedy("is not a text, or too long");
  return {};
}

void StrictJson::refuse_other_keys() const {
  if (!value_->is_object()) return refuse_with_remedy("is not an object");
  for (const auto& [key, value] : value_->items()) {
    if (std::ranges::find(requested_, key) == requested_.end())
      refuse("has a key that is not known, '" + key.substr(0, kMaxKey) + "'; remove it");
  }
}

void StrictJson::refuse(const std::string& what) const {
  if (!mistakes_->is_any) mistakes_->first = path_ + ": " + what;
  mistakes_->is_any = true;
}

Result<nlohmann::json> parse_document(std::string_view text, const std::string& name, std::string_view remedy) {
  try {
    return nlohmann::json::parse(text);
  } catch (const nlohmann::json::parse_error& error) {
    return Error(ErrorCode::kBadData, fmt::format("{}: byte {}: no JSON; {}", name, error.byte, remedy));
  } catch (const nlohmann::json::exception& error) {
    return Error(ErrorCode::kBadData, fmt::format("{}: {}; {}", name, printable(error.what(), 200), remedy));
  }
}

}  // namespace cyclorama
