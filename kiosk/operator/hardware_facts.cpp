// SPDX-License-Identifier: Apache-2.0
#include "kiosk/operator/hardware_facts.h"

#include <algorithm>
#include <array>
#include <functional>
#include <string_view>
#include <system_error>
#include <utility>

#include "common/base/text.h"
#include "kiosk/operator/kernel_file.h"

namespace cyclorama::operations {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view kDisplayClass = "0x03";  // PCI's class of display controllers.
constexpr std::string_view kVideoClass = "0e";      // USB's class of cameras (UVC).
constexpr std::string_view kMiscClass = "ef";       // With subclass 05: USB3 Vision.
constexpr std::string_view kVisionSubclass = "05";
constexpr std::array<std::pair<std::string_view, const char*>, 3> kMakers{
    {{"1002", "AMD"}, {"8086", "Intel"}, {"10de", "NVIDIA"}}};

/// Returns the first line of a file of the kernel; empty if there is none.
std::string first_line_of(const fs::path& path) {
  const std::string text = read_kernel_file(path).value_or("");
  return text.substr(0, text.find('\n'));
}

/// Calls `look` for each entry of a folder, in the order of their names.
void each(const fs::path& folder, const std::function<void(const fs::path&)>& look) {
  std::vector<fs::path> entries;
  std::error_code failed;
  for (fs::directory_iterator entry(folder, failed), end; !failed && entry != end; entry.increment(failed)) {
    entries.push_back(entry->path());
  }
  std::ranges::sort(entries);
  for (const fs::path& entry : entries) look(entry);
}

/// Returns the name of the driver that took a device; empty: none.
std::string driver_of(const fs::path& device) {
  std::error_code none;
  return fs::read_symlink(device / "driver", none).filename().string();
}

void read_cards(const fs::path& root, HardwareFacts* ret) {
  each(root / "sys/bus/pci/devices", [&](const fs::path& device) {
    if (!first_line_of(device / "class").starts_with(kDisplayClass)) return;
    constexpr std::size_t kPrefix = 2;  // "0x"
    const std::string vendor = first_line_of(device / "vendor");
    const std::string model = first_line_of(device / "device");
    if (vendor.size() <= kPrefix || model.size() <= kPrefix) return;
    GraphicsCard card{"", vendor.substr(kPrefix) + ":" + model.substr(kPrefix), driver_of(device)};
    for (const auto& [id, maker] : kMakers) {
      if (vendor.substr(kPrefix) == id) card.maker = maker;
    }
    ret->cards.push_back(std::move(card));
  });
}

/// Returns a property in the text of udev's database, which has lines such as "E:ID_BUS=usb".
std::string property(const std::string& known, const std::string& key) {
  const std::string begin = "\nE:" + key + "=";
  const std::size_t at = known.find(begin);
  if (at == std::string::npos) return "";
  return known.substr(at + begin.size(), known.find('\n', at + 1) - at - begin.size());
}

/// A stick with partitions has no file system of its own, and its partitions are looked at one by one.
void read_sticks(const fs::path& root, HardwareFacts* ret) {
  each(root / "sys/class/block", [&](const fs::path& block) {
    const std::string known =
        "\n" + read_kernel_file(root / "run/udev/data" / ("b" + first_line_of(block / "dev"))).value_or("");
    if (property(known, "ID_BUS") != "usb" || first_line_of(block / "size") == "0") return;
    const std::string file_system = property(known, "ID_FS_TYPE");
    const bool is_whole = property(known, "DEVTYPE") != "partition" && !property(known, "ID_PART_TABLE_TYPE").empty();
    if (file_system == "vfat" || (file_system.empty() && is_whole)) return;
    ret->sticks.push_back({block.filename().string(), printable(file_system, 20)});
  });
}

void read_cameras(const fs::path& root, HardwareFacts* ret) {
  std::string last;
  each(root / "sys/bus/usb/devices", [&](const fs::path& interface) {
    const std::string name = interface.filename().string();
    const std::size_t colon = name.find(':');
    if (colon == std::string::npos || !driver_of(interface).empty()) return;
    const std::string kind = first_line_of(interface / "bInterfaceClass");
    const bool is_vision = kind == kMiscClass && first_line_of(interface / "bInterfaceSubClass") == kVisionSubclass;
    if ((kind != kVideoClass && !is_vision) || name.substr(0, colon) == last) return;
    last = name.substr(0, colon);  // A camera has several interfaces.
    const std::string product = printable(first_line_of(interface.parent_path() / last / "product"), 80);
    ret->cameras.push_back({product.empty() ? "a camera" : product, is_vision});
  });
}

}  // namespace

HardwareFacts read_hardware_facts(const fs::path& root) {
  HardwareFacts facts;
  read_cards(root, &facts);
  read_sticks(root, &facts);
  read_cameras(root, &facts);
  return facts;
}

}  // namespace cyclorama::operations
