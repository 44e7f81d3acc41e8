// SPDX-License-Identifier: Apache-2.0
/// Errors as values, described once, where they happen.
#pragma once

#include <string>
#include <string_view>

namespace cyclorama {

/// Coarse kind of an error; callers branch on nothing else.
enum class ErrorCode {
  kInvalidArgument,  ///< The caller's input can never succeed.
  kNotFound,         ///< A device, file or peer is absent.
  kBusy,             ///< Held by another process; retrying later may help.
  kUnavailable,      ///< A transient failure, such as a link that is down or a node that restarts. Retry with back-off.
  kTimedOut,         ///< A deadline passed.
  kBadData,          ///< Received bytes are not in the promised form.
  kSystem,           ///< The reason is in errno.
};

/// Source line where an error was made. Has the shape of std::source_location, which clang-tidy 14 cannot parse.
struct SourceLine {
  const char* file = "";
  int line = 0;
  static constexpr SourceLine current(const char* file = __builtin_FILE(), int line = __builtin_LINE()) {
    return {file, line};
  }
};

class Error {
 public:
  Error(ErrorCode code, std::string message,
        SourceLine where = SourceLine::current());

  /// Makes an error from errno, for example Error::from_errno("opening '/dev/dri/card0'").
  static Error from_errno(std::string_view doing,
                          SourceLine where = SourceLine::current());

  /// Puts the caller's action in front: "lighting projector 2: opening '/dev/dri/card0': Device or resource busy".
  [[nodiscard]] Error while_doing(std::string_view doing) &&;

  [[nodiscard]] ErrorCode code() const { return code_; }
  [[nodiscard]] const std::string& message() const { return message_; }
  [[nodiscard]] int errno_value() const { return errno_value_; }
  [[nodiscard]] const SourceLine& where() const { return where_; }

 private:
  ErrorCode code_;
  int errno_value_ = 0;
  std::string message_;
  SourceLine where_;
};

}  // namespace cyclorama
