// SPDX-License-Identifier: Apache-2.0
#include "drivers/output/drm/kms.h"

#include <cerrno>

namespace cyclorama::output {

Error kms_error(int negative_errno, std::string_view doing) {
  errno = -negative_errno;
  return Error::from_errno(doing);
}

bool is_master_lost(const Error& error) { return error.errno_value() == EACCES || error.errno_value() == EPERM; }

bool is_card_lost(const Error& error) { return error.errno_value() == ENODEV || error.errno_value() == ENXIO; }

}  // namespace cyclorama::output
