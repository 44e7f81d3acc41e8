// SPDX-License-Identifier: Apache-2.0
/// One line per event, for an operator. Only mains and the services that give up log; libraries return errors.
#pragma once

#include <span>
#include <string>
#include <string_view>

namespace cyclorama {

/// syslog's levels; under systemd the journal sees them (sd-daemon(3) prefixes), on a terminal people see words.
enum class LogLevel { kError = 3, kWarning = 4, kNotice = 5, kInfo = 6, kDebug = 7 };

/// What an entry of the journal carries besides its sentence, to be searched by: journalctl CYCLORAMA_NODE=render-07.
struct LogField {
  std::string_view name;  ///< As the journal wants it: "CYCLORAMA_NODE".
  std::string value;
};

/// Writes one line to standard error; where that is the journal, an entry with the fields, of which those without a
/// value are left out. Control bytes are made printable. Thread-safe.
void log(LogLevel level, std::string_view message, std::span<const LogField> fields = {});

/// Drops what is less urgent than `least`; kInfo at the start. Thread-safe.
void set_log_level(LogLevel min);

}  // namespace cyclorama
