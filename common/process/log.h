// SPDX-License-Identifier: Apache-2.0
/// One line per event, for an operator. Only main programs, and services that give up, write logs; libraries return
/// errors.
#pragma once

#include <span>
#include <string>
#include <string_view>

namespace cyclorama {

/// syslog's levels: passed to the journal under systemd (sd-daemon(3) prefixes), and printed as words on a terminal.
enum class LogLevel { kError = 3, kWarning = 4, kNotice = 5, kInfo = 6, kDebug = 7 };

/// Searchable field of a journal entry in addition to its sentence: journalctl CYCLORAMA_NODE=render-07.
struct LogField {
  std::string_view name;  ///< In the journal's form: "CYCLORAMA_NODE".
  std::string value;
};

/// Writes one line to standard error; if that is the journal, an entry with those fields that have a value. Control
/// bytes are made printable. Thread-safe.
void log(LogLevel level, std::string_view message, std::span<const LogField> fields = {});

/// Drops messages less urgent than `min`; the default is kInfo. Thread-safe.
void set_log_level(LogLevel min);

}  // namespace cyclorama
