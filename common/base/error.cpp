// SPDX-License-Identifier: Apache-2.0
#include "common/base/error.h"

#include <cerrno>
#include <system_error>
#include <utility>

namespace cyclorama {

Error::Error(ErrorCode code, std::string message, SourceLine where)
    : code_(code), message_(std::move(message)), where_(where) {}

Error Error::from_errno(std::string_view doing, SourceLine where) {
  const int saved_errno = errno;
  const ErrorCode code = saved_errno == ENOENT || saved_errno == ENODEV ? ErrorCode::kNotFound
                         : saved_errno == EBUSY                        ? ErrorCode::kBusy
                                                                        : ErrorCode::kSystem;
  Error error(code, std::string(doing) + ": " + std::generic_category().message(saved_errno), where);
  error.errno_value_ = saved_errno;
  return error;
}

Error Error::while_doing(std::string_view doing) && {
  message_ = std::string(doing) + ": " + message_;
  return std::move(*this);
}

}  // namespace cyclorama
