// SPDX-License-Identifier: Apache-2.0
#include "kiosk/provision/operator_settings.h"

#include <utility>

#include "common/config/config.h"
#include "kiosk/provision/pin.h"

namespace cyclorama {

Result<OperatorSettings> parse_operator_settings(std::string_view text, std::string name) {
  TRY_ASSIGN(Config config, Config::parse(text, std::move(name)));
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

}  // namespace cyclorama
