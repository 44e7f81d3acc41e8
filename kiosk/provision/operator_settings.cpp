// SPDX-License-Identifier: Apache-2.0
#include "kiosk/provision/operator_settings.h"

#include <cstddef>

#include "common/config/config.h"
#include "kiosk/provision/pin.h"

namespace cyclorama::provision {
namespace {

/// Removes what may quote the PIN: a TOML reader's message may quote the file, and everybody can read it on the page
/// that requires the PIN. Only the position stays, except in sentences that are known to quote nothing.
Error without_quotes(const Error& error, const std::string& name) {
  const std::string& message = error.message();
  const std::size_t line = name.size() + 1;
  const std::size_t end = message.find_first_not_of("0123456789", line);
  if (!message.starts_with(name + ":") || end == std::string::npos) return {error.code(), name + " cannot be read"};
  const std::string_view said = std::string_view(message).substr(end);
  if (said.starts_with(": pin: must be a text in quotes") || said.starts_with(": pin: is refused: the PIN ")) {
    return {error.code(), message.substr(0, message.find(" (and "))};
  }
  return {error.code(), message.substr(0, end) +
                            ": is not understood; write one line, pin = \"...\", with the PIN between the quotes, and "
                            "nothing else"};
}

Result<OperatorSettings> read(std::string_view text, const std::string& name) {
  TRY_ASSIGN(Config config, Config::parse(text, name));
  ConfigTable root = config.root();
  OperatorSettings settings;
  if (root.has("pin")) {
    std::string pin;
    for (const char c : root.text("pin")) {
      if (c != ' ') pin += c;
    }
    if (const Status good = check_pin(pin); !good) root.refuse("pin", "is refused: " + good.error().message());
    settings.pin = std::move(pin);
  }
  TRY(config.finish());
  return settings;
}

}  // namespace

Result<OperatorSettings> parse_operator_settings(std::string_view text, std::string name) {
  auto settings = read(text, name);
  if (!settings) return without_quotes(settings.error(), name);
  return settings;
}

}  // namespace cyclorama::provision
