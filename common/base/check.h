// SPDX-License-Identifier: Apache-2.0
/// CHECK(condition) stops the process at a bug (a broken precondition or invariant), in every build; systemd restarts
/// the process, and the core file shows the place. It is never used for input, config, wire or device data: those
/// return an Error.
#pragma once

#include <cstdio>
#include <cstdlib>

#define CHECK(condition)                                                                        \
  do {                                                                                          \
    if (!(condition)) {                                                                         \
      std::fprintf(stderr, "%s:%d: CHECK failed: %s\n", __FILE__, __LINE__, #condition);        \
      std::abort();                                                                             \
    }                                                                                           \
  } while (false)
