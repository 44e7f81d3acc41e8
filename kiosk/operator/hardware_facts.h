// SPDX-License-Identifier: Apache-2.0
/// What is built into this computer or plugged in, and does not work with our image: graphics cards without a driver,
/// sticks with a file system that is not read, cameras without a driver.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace cyclorama::operations {

struct GraphicsCard {
  std::string maker;   ///< "AMD", "Intel", "NVIDIA"; empty: another, such as a virtual machine's.
  std::string id;      ///< Vendor and device of PCI: "1002:7550".
  std::string driver;  ///< "amdgpu"; empty: none took it.
};

struct UnreadStick {
  std::string block;        ///< "sda1".
  std::string file_system;  ///< "exfat", "ntfs"; empty: none is on it.
};

struct UndrivenCamera {
  std::string name;            ///< The product name in the camera.
  bool is_industrial = false;  ///< It has USB3 Vision instead of the cameras' common language (UVC).
};

/// A value.
struct HardwareFacts {
  std::vector<GraphicsCard> cards{};
  std::vector<UnreadStick> sticks{};
  std::vector<UndrivenCamera> cameras{};
};

/// Reads /sys and udev's database below `root`, which is "/" except in tests.
[[nodiscard]] HardwareFacts read_hardware_facts(const std::filesystem::path& root = "/");

}  // namespace cyclorama::operations
