// SPDX-License-Identifier: Apache-2.0
/// Result<T>: a T or an Error. Its shape is that of tl::expected and std::expected. It has only the members below, so
/// that it can become an alias of std::expected under C++23.
#pragma once

#include <utility>
#include <variant>

#include "common/base/check.h"
#include "common/base/error.h"

namespace cyclorama {

template <typename T>
class [[nodiscard]] Result {
 public:
  Result(T value) : state_(std::in_place_index<0>, std::move(value)) {}      // NOLINT(google-explicit-constructor)
  Result(Error error) : state_(std::in_place_index<1>, std::move(error)) {}  // NOLINT(google-explicit-constructor)

  [[nodiscard]] bool has_value() const { return state_.index() == 0; }
  explicit operator bool() const { return has_value(); }

  /// Precondition: has_value().
  T& operator*() & { CHECK(has_value()); return *std::get_if<0>(&state_); }
  const T& operator*() const& { CHECK(has_value()); return *std::get_if<0>(&state_); }
  T&& operator*() && { CHECK(has_value()); return std::move(*std::get_if<0>(&state_)); }
  T* operator->() { return &**this; }
  const T* operator->() const { return &**this; }

  /// Precondition: !has_value().
  const Error& error() const& { CHECK(!has_value()); return *std::get_if<1>(&state_); }
  Error&& error() && { CHECK(!has_value()); return std::move(*std::get_if<1>(&state_)); }

 private:
  std::variant<T, Error> state_;
};

struct Done {};
using Status = Result<Done>;

}  // namespace cyclorama

#define CYCLORAMA_CONCAT_(a, b) a##b
#define CYCLORAMA_CONCAT(a, b) CYCLORAMA_CONCAT_(a, b)

/// Declares `lhs` with the value of a Result, or returns the Result's Error from the current function.
#define TRY_ASSIGN(lhs, ...) CYCLORAMA_TRY_ASSIGN_(CYCLORAMA_CONCAT(try_result_, __LINE__), lhs, __VA_ARGS__)
#define CYCLORAMA_TRY_ASSIGN_(result, lhs, ...)             \
  auto result = (__VA_ARGS__);                           \
  if (!result) return std::move(result).error();         \
  lhs = *std::move(result)

/// Returns the Error of a Status from the current function, if there is one.
#define TRY(...)                                                          \
  do {                                                                    \
    if (auto try_status = (__VA_ARGS__); !try_status) return std::move(try_status).error(); \
  } while (false)
