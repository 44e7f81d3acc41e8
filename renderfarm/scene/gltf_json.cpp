// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/scene/gltf_json.h"

#include <fmt/format.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "common/base/check.h"
#include "common/base/text.h"

namespace cyclorama::scene {
namespace {

constexpr double kMaxExactInteger = 9007199254740992.0;  // 2^53

std::optional<std::uint64_t> whole_number(const nlohmann::json& value) {
  if (value.is_number_unsigned()) return *value.get_ptr<const nlohmann::json::number_unsigned_t*>();
  if (!value.is_number_float()) return std::nullopt;
  const double number = *value.get_ptr<const nlohmann::json::number_float_t*>();
  if (!(number >= 0.0 && number <= kMaxExactInteger) || number != std::floor(number)) return std::nullopt;
  return static_cast<std::uint64_t>(number);
}

std::optional<double> finite_number(const nlohmann::json& value) {
  if (!value.is_number()) return std::nullopt;
  const auto number = value.get<double>();
  if (!std::isfinite(number)) return std::nullopt;
  return number;
}

// Returns the JSON pointer of a child, with '~' and '/' escaped as in RFC 6901.
std::string child_place(std::string_view place, std::string_view key) {
  std::string child(place);
  child += '/';
  for (const char c : printable(key)) {
    if (c == '~') {
      child += "~0";
    } else if (c == '/') {
      child += "~1";
    } else {
      child += c;
    }
  }
  return child;
}

}  // namespace

Error gltf_damaged(std::string_view place, std::string_view what) {
  return Error(ErrorCode::kBadData, fmt::format("{}: {}; the file is damaged, export it again",
                                                place.empty() ? std::string_view("the JSON") : place, what));
}

Result<GltfObject> GltfObject::from(const nlohmann::json& value, std::string place) {
  if (!value.is_object()) return gltf_damaged(place, "an object is needed here");
  return GltfObject(&value, std::move(place));
}

const nlohmann::json* GltfObject::find(const char* key) const {
  const auto it = value_->find(key);
  return it == value_->end() ? nullptr : &*it;
}

bool GltfObject::has(const char* key) const { return find(key) != nullptr; }

Error GltfObject::damaged(std::string_view key, std::string_view what) const {
  return gltf_damaged(child_place(place_, key), what);
}

Result<std::optional<double>> GltfObject::number(const char* key) const {
  const nlohmann::json* const value = find(key);
  if (value == nullptr) return std::optional<double>();
  const std::optional<double> number = finite_number(*value);
  if (!number) return damaged(key, "a number is needed here");
  return number;
}

Result<std::optional<std::uint64_t>> GltfObject::integer(const char* key) const {
  const nlohmann::json* const value = find(key);
  if (value == nullptr) return std::optional<std::uint64_t>();
  const std::optional<std::uint64_t> number = whole_number(*value);
  if (!number) return damaged(key, "a whole number that is not negative is needed here");
  return number;
}

Result<std::uint64_t> GltfObject::required_integer(const char* key) const {
  TRY_ASSIGN(const std::optional<std::uint64_t> number, integer(key));
  if (!number) return damaged(key, "is missing");
  return *number;
}

Result<std::optional<bool>> GltfObject::flag(const char* key) const {
  const nlohmann::json* const value = find(key);
  if (value == nullptr) return std::optional<bool>();
  const bool* const flag = value->get_ptr<const nlohmann::json::boolean_t*>();
  if (flag == nullptr) return damaged(key, "true or false is needed here");
  return std::optional(*flag);
}

Result<std::optional<std::string>> GltfObject::text(const char* key) const {
  const nlohmann::json* const value = find(key);
  if (value == nullptr) return std::optional<std::string>();
  const std::string* const text = value->get_ptr<const nlohmann::json::string_t*>();
  if (text == nullptr) return damaged(key, "text is needed here");
  return std::optional(*text);
}

Result<std::string> GltfObject::text_or(const char* key, const char* fallback) const {
  TRY_ASSIGN(std::optional<std::string> found, text(key));
  if (!found) return std::string(fallback);
  return *std::move(found);
}

std::string GltfObject::name() const {
  const nlohmann::json* const value = find("name");
  const std::string* const text = value == nullptr ? nullptr : value->get_ptr<const nlohmann::json::string_t*>();
  return text == nullptr ? std::string() : *text;
}

Result<std::optional<GltfObject>> GltfObject::object(const char* key) const {
  const nlohmann::json* const value = find(key);
  if (value == nullptr) return std::optional<GltfObject>();
  TRY_ASSIGN(GltfObject object, from(*value, child_place(place_, key)));
  return std::optional(std::move(object));
}

Result<std::optional<GltfObject>> GltfObject::extension(const char* name) const {
  TRY_ASSIGN(const std::optional<GltfObject> extensions, object("extensions"));
  if (!extensions) return std::optional<GltfObject>();
  return extensions->object(name);
}

Result<GltfArray> GltfObject::array(const char* key) const {
  const nlohmann::json* const value = find(key);
  if (value != nullptr && !value->is_array()) return damaged(key, "an array is needed here");
  return GltfArray(value, child_place(place_, key));
}

Result<bool> GltfObject::numbers_into(const char* key, double* ret_values, std::size_t count) const {
  const nlohmann::json* const value = find(key);
  if (value == nullptr) return false;
  if (!value->is_array() || value->size() != count)
    return damaged(key, fmt::format("{} numbers are needed here", count));
  for (std::size_t i = 0; i < count; ++i) {
    const std::optional<double> number = finite_number((*value)[i]);
    if (!number) return damaged(key, fmt::format("{} numbers are needed here", count));
    ret_values[i] = *number;
  }
  return true;
}

std::size_t GltfArray::size() const { return value_ == nullptr ? 0 : value_->size(); }

std::string GltfArray::place_of(std::size_t index) const { return fmt::format("{}/{}", place_, index); }

Result<GltfObject> GltfArray::object(std::size_t index) const {
  CHECK(index < size());
  return GltfObject::from((*value_)[index], place_of(index));
}

Result<std::uint64_t> GltfArray::integer(std::size_t index) const {
  CHECK(index < size());
  const std::optional<std::uint64_t> number = whole_number((*value_)[index]);
  if (!number) return gltf_damaged(place_of(index), "a whole number that is not negative is needed here");
  return *number;
}

Result<double> GltfArray::number(std::size_t index) const {
  CHECK(index < size());
  const std::optional<double> number = finite_number((*value_)[index]);
  if (!number) return gltf_damaged(place_of(index), "a number is needed here");
  return *number;
}

Result<std::string> GltfArray::text(std::size_t index) const {
  CHECK(index < size());
  const std::string* const text = (*value_)[index].get_ptr<const nlohmann::json::string_t*>();
  if (text == nullptr) return gltf_damaged(place_of(index), "text is needed here");
  return *text;
}

}  // namespace cyclorama::scene
