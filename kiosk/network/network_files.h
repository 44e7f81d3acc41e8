// SPDX-License-Identifier: Apache-2.0
/// The files by which a museum's [network] reaches systemd-networkd, wpa_supplicant and the updater.
///
///   RUN/systemd/network/20-museum-cable.network     addresses, servers; or, with a VLAN, only the cable beneath it
///   RUN/systemd/network/20-museum-vlan.netdev, .network
///   RUN/cyclorama-8021x/login.conf, login.env        the login at the switch's port
///   RUN/cyclorama-network/proxy.env                  for the updater
///
/// All of them are gone after a restart, so settings that were only tried never outlive one.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "common/base/result.h"
#include "common/network/network_settings.h"

namespace cyclorama::network {

struct NetworkFile {
  std::filesystem::path path;  ///< Relative to RUN.
  std::string content;
  bool is_secret = false;  ///< Its folder is root's alone.
};

/// Returns the files for these settings, which have no mistake. `folders` are searched for the files that the login
/// names, the first one first. Errors: kNotFound or kSystem, naming the setting, if one of these cannot be read;
/// kBadData if the password has no first line.
Result<std::vector<NetworkFile>> network_files(const NetworkSettings& network,
                                               const std::vector<std::filesystem::path>& folders);

/// Writes the files that differ, and removes those of other settings. Returns the names of all that changed. Errors:
/// kSystem if the disk fails.
Result<std::vector<std::string>> put_network_files(const std::vector<NetworkFile>& files,
                                                   const std::filesystem::path& run);

}  // namespace cyclorama::network
