// SPDX-License-Identifier: Apache-2.0
/// Power control of projectors over the network: PJLink class 1 (JBMIA, "PJLink specifications class 1", version 1.04,
/// 2013). Each command uses its own connection, since projectors close an idle connection after 30 s.
#pragma once

#include <array>
#include <chrono>
#include <string>
#include <string_view>

#include "common/base/address.h"
#include "common/base/result.h"

namespace cyclorama::output {

enum class ProjectorPower { kOff, kOn, kCooling, kWarming };
/// Returns "off", "on", "cooling down" or "warming up", for people.
[[nodiscard]] std::string_view text_of(ProjectorPower power);

struct PjlinkProjector {
  Address address;       ///< Port 4352 by the specification.
  std::string password;  ///< Empty if the projector has none.
};

/// Error status of a projector's parts (ERST).
struct ProjectorErrors {
  enum class Kind { kNone, kWarning, kError };
  std::array<Kind, 6> of{};  ///< Fan, lamp, temperature, cover, filter, other.
};

/// Blocks for at most `timeout`.
/// Errors: kUnavailable if the projector does not answer or cannot answer now, for example while it cools down (retry);
/// kInvalidArgument if the password is wrong or missing; kBadData if it does not follow PJLink (the message shows its
/// answer); kSystem if the projector reports a failure.
Result<ProjectorPower> query_power(const PjlinkProjector& projector, std::chrono::milliseconds timeout);
/// Errors: those of query_power(). Succeeds also if the projector is already in that state.
Status set_power(const PjlinkProjector& projector, bool is_on, std::chrono::milliseconds timeout);
/// Errors: those of query_power().
Result<ProjectorErrors> query_errors(const PjlinkProjector& projector, std::chrono::milliseconds timeout);

/// The parts of the protocol, without a network. `line` comes without its carriage return.
namespace pjlink {
constexpr std::size_t kMaxLineLength = 136;  // Section 5.1.2: header, separator and a parameter of 128 characters.

/// Returns the prefix of a command, from the projector's first line: empty, or 32 hexadecimal digits.
Result<std::string> authorise(std::string_view greeting, std::string_view password);
/// Returns the parameter of the answer to a command, such as POWR. Errors: those of query_power().
Result<std::string> parse_answer(std::string_view line, std::string_view command = "POWR");
Result<ProjectorPower> parse_power(std::string_view line);
/// Parses the parameter of an answer to ERST.
Result<ProjectorErrors> parse_errors(std::string_view line);
}  // namespace pjlink

}  // namespace cyclorama::output
