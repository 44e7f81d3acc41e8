// SPDX-License-Identifier: Apache-2.0
#include "kiosk/operator/sign_stick_command.h"

#include <fmt/format.h>

#include <cstdio>

#include "kiosk/provision/owner_key.h"

namespace cyclorama::operations {

void SignStickCommand::add_to(CLI::App* app) {
  CLI::App& command = *app->add_subcommand(
      "sign-stick", "Sign a stick's settings, so that museums which know the key take them without a confirmation");
  command.add_option("FOLDER", folder, "The stick's folder 'cyclorama', when all its files are as they should be")
      ->required();
  command.add_option("--key", key, "The owner's private key, made if it is missing; keep it, but not on the stick")
      ->required();
}

Status SignStickCommand::run() const {
  TRY(provision::sign_stick(folder, key));
  fmt::print(
      "'{}' is signed. A new museum keeps this key with its first stick; any other takes the stick if it knows the "
      "key, or when somebody confirms it on its page. Sign again after each change.\n",
      folder);
  return Done{};
}

}  // namespace cyclorama::operations
