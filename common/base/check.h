// SPDX-License-Identifier: Apache-2.0
/// CHECK(condition): a bug (broken precondition or invariant) stops the process here, in every build; systemd restarts
/// it and the core says where. Never for input, config, wire or device data: those return an Error.
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
