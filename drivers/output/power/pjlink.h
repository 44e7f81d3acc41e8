// SPDX-License-Identifier: Apache-2.0
/// Projectors' power over the network: PJLink class 1 (JBMIA, "PJLink specifications class 1", version 1.04, 2013). One
/// command per connection, since projectors close an idle one after 30 s.
#pragma once

#include <array>
#include <chrono>
#include <string>
#include <string_view>

#include "common/base/address.h"
#include "common/base/result.h"

namespace cyclorama::output {

enum class ProjectorPower { kOff, kOn, kCooling, kWarming };
/// "off", "on", "cooling down", "warming up", for people.
[[nodiscard]] std::string_view text_of(ProjectorPower power);

struct PjlinkProjector {
  Address address;       ///< Port 4352 by the specification.
  std::string password;  ///< Empty: none.
};

/// What a projector tells of its parts.
struct ProjectorErrors {
  enum class Kind { kNone, kWarning, kError };
  std::array<Kind, 6> of{};  ///< Fan, lamp, temperature, cover, filter, other.
};

/// Blocks for at most `timeout`. kUnavailable  it does not answer, or cannot just now (it cools down); ask again.
/// kInvalidArgument  the password is wrong or missing.   kBadData  it does not speak PJLink; the message shows what
/// came. kSystem  the projector reports a failure.
Result<ProjectorPower> query_power(const PjlinkProjector& projector, std::chrono::milliseconds timeout);
/// As query_power(). Also fine when it is so already.
Status set_power(const PjlinkProjector& projector, bool is_on, std::chrono::milliseconds timeout);
/// As query_power().
Result<ProjectorErrors> query_errors(const PjlinkProjector& projector, std::chrono::milliseconds timeout);

/// The parts of the protocol, without a network. `line` comes without its carriage return.
namespace pjlink {
constexpr std::size_t kMaxLineLength = 136;  // 5.1.2: 128 of a parameter, header and separator.

/// What to put before a command, from the projector's first line: nothing, or 32 hexadecimal digits.
Result<std::string> authorise(std::string_view greeting, std::string_view password);
/// The parameter of an answer to a command, such as POWR. Errors as query_power().
Result<std::string> parse_answer(std::string_view line, std::string_view command = "POWR");
Result<ProjectorPower> parse_power(std::string_view line);
/// Of an answer to ERST.
Result<ProjectorErrors> parse_errors(std::string_view line);
}  // namespace pjlink

}  // namespace cyclorama::output
