// SPDX-License-Identifier: Apache-2.0
/// Strict reader of glTF's JSON. Any deviation from the specification is an error that names the place as a JSON
/// pointer ("/accessors/3/count: ..."). The importer prefixes the file's name.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <string_view>

#include "common/base/result.h"

namespace cyclorama::scene {

class GltfArray;

/// Returns a kBadData error, with the remedy that applies to every damaged file.
Error gltf_damaged(std::string_view place, std::string_view what);

/// One JSON object and its place. Borrows the parsed document. An absent key is an empty optional; a key of the wrong
/// type is kBadData.
class GltfObject {
 public:
  static Result<GltfObject> from(const nlohmann::json& value, std::string place);

  [[nodiscard]] const std::string& place() const { return place_; }
  [[nodiscard]] bool has(const char* key) const;
  [[nodiscard]] Error damaged(std::string_view key, std::string_view what) const;

  Result<std::optional<double>> number(const char* key) const;
  /// Returns a whole number that is not negative; "3.0" counts as whole.
  Result<std::optional<std::uint64_t>> integer(const char* key) const;
  Result<std::uint64_t> required_integer(const char* key) const;
  Result<std::optional<bool>> flag(const char* key) const;
  Result<std::optional<std::string>> text(const char* key) const;
  Result<std::string> text_or(const char* key, const char* fallback) const;
  /// Returns the optional "name" of an object. It is never an error, because only people read it.
  [[nodiscard]] std::string name() const;
  Result<std::optional<GltfObject>> object(const char* key) const;
  /// Returns the member `name` of the object "extensions".
  Result<std::optional<GltfObject>> extension(const char* name) const;
  /// Returns an array; empty if the key is absent.
  Result<GltfArray> array(const char* key) const;

  template <std::size_t N>
  Result<std::optional<std::array<double, N>>> numbers(const char* key) const {
    std::array<double, N> values{};
    TRY_ASSIGN(const bool present, numbers_into(key, values.data(), N));
    if (!present) return std::optional<std::array<double, N>>();
    return std::optional(values);
  }

 private:
  GltfObject(const nlohmann::json* value, std::string place) : value_(value), place_(std::move(place)) {}
  [[nodiscard]] const nlohmann::json* find(const char* key) const;
  Result<bool> numbers_into(const char* key, double* ret_values, std::size_t count) const;

  const nlohmann::json* value_;
  std::string place_;
};

/// One JSON array and its place; borrows the parsed document.
class GltfArray {
 public:
  GltfArray(const nlohmann::json* value, std::string place) : value_(value), place_(std::move(place)) {}

  [[nodiscard]] const std::string& place() const { return place_; }
  [[nodiscard]] std::size_t size() const;
  /// Precondition of this function and the next four: index < size().
  Result<GltfObject> object(std::size_t index) const;
  Result<std::uint64_t> integer(std::size_t index) const;
  [[nodiscard]] Result<double> number(std::size_t index) const;
  Result<std::string> text(std::size_t index) const;
  [[nodiscard]] std::string place_of(std::size_t index) const;

 private:
  const nlohmann::json* value_;  // Null for an absent array.
  std::string place_;
};

}  // namespace cyclorama::scene
