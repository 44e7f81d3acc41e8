// SPDX-License-Identifier: Apache-2.0
/// What went wrong, said once, where it happened.
#pragma once

#include <string>
#include <string_view>

namespace cyclorama {

/// Coarse kind; a caller branches on this and on nothing else.
enum class ErrorCode {
  kInvalidArgument,  ///< The caller's input can never work.
  kNotFound,         ///< A device, file or peer is absent.
  kBusy,             ///< It exists but another process holds it. Retrying may help.
  kUnavailable,      ///< Transient: link down, node restarting. Retry with backoff.
  kTimedOut,         ///< A deadline passed.
  kBadData,          ///< Bytes arrived and are not what was promised.
  kSystem,           ///< errno() says why.
};

/// Where an error was made. std::source_location's shape; clang-tidy 14 cannot parse the std one.
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

  /// From errno, e.g. Error::from_errno("opening '/dev/dri/card0'").
  static Error from_errno(std::string_view doing,
                          SourceLine where = SourceLine::current());

  /// Prefixes what the caller was doing: "lighting projector 2: opening '/dev/dri/card0': Device or resource busy".
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
