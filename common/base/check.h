// SPDX-License-Identifier: Apache-2.0
/// CHECK(condition) aborts the process on a bug (a broken precondition or invariant), in every build. systemd restarts
/// the process, and the core file shows where it stopped. Input, settings, messages and device data are never checked
/// with it: they return an Error.
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
