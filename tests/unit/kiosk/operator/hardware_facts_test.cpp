// SPDX-License-Identifier: Apache-2.0
#include "kiosk/operator/hardware_facts.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "common/base/file.h"
#include "kiosk/operator/checks.h"

namespace cyclorama::operations {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::SizeIs;

/// A computer's /sys and /run, as far as they are read.
class HardwareFactsTest : public testing::Test {
 protected:
  HardwareFactsTest() {
    std::string name = (fs::temp_directory_path() / "hardware-XXXXXX").string();
    EXPECT_NE(::mkdtemp(name.data()), nullptr);
    root_ = name;
  }
  ~HardwareFactsTest() override { fs::remove_all(root_); }

  void write(const std::string& path, const std::string& text) const {
    fs::create_directories((root_ / path).parent_path());
    EXPECT_TRUE(write_file_atomically(root_ / path, std::string_view(text)));
  }
  void add_pci(const std::string& slot, const std::string& kind, const std::string& vendor, const std::string& device,
               const std::string& driver) const {
    const std::string at = "sys/bus/pci/devices/" + slot;
    write(at + "/class", kind + "\n");
    write(at + "/vendor", "0x" + vendor + "\n");
    write(at + "/device", "0x" + device + "\n");
    if (!driver.empty()) fs::create_symlink("../../drivers/" + driver, root_ / at / "driver");
  }
  void add_block(const std::string& name, const std::string& number, const std::string& udev) const {
    write("sys/class/block/" + name + "/dev", number + "\n");
    write("sys/class/block/" + name + "/size", "60000\n");
    write("run/udev/data/b" + number, udev);
  }
  void add_usb(const std::string& device, const std::string& product,
               const std::vector<std::pair<std::string, std::string>>& interfaces, const std::string& driver) const {
    write("sys/bus/usb/devices/" + device + "/product", product + "\n");
    int number = 0;
    for (const auto& [kind, subclass] : interfaces) {
      const std::string at = "sys/bus/usb/devices/" + device + ":1." + std::to_string(number++);
      write(at + "/bInterfaceClass", kind + "\n");
      write(at + "/bInterfaceSubClass", subclass + "\n");
      if (!driver.empty()) fs::create_symlink("../../drivers/" + driver, root_ / at / "driver");
    }
  }

  fs::path root_;
};

TEST_F(HardwareFactsTest, name_each_graphics_card_and_its_driver) {
  add_pci("0000:00:02.0", "0x030000", "8086", "46a6", "i915");
  add_pci("0000:01:00.0", "0x030000", "10de", "2684", "");
  add_pci("0000:00:1f.3", "0x040300", "8086", "51c8", "snd_hda_intel");
  const HardwareFacts facts = read_hardware_facts(root_);
  ASSERT_THAT(facts.cards, SizeIs(2));
  EXPECT_EQ(facts.cards[0].maker, "Intel");
  EXPECT_EQ(facts.cards[0].driver, "i915");
  EXPECT_EQ(facts.cards[1].maker, "NVIDIA");
  EXPECT_EQ(facts.cards[1].id, "10de:2684");
  EXPECT_EQ(facts.cards[1].driver, "");
}

TEST_F(HardwareFactsTest, name_sticks_that_are_not_read) {
  add_block("sda", "8:0", "E:DEVTYPE=disk\nE:ID_BUS=usb\nE:ID_PART_TABLE_TYPE=dos\n");
  add_block("sda1", "8:1", "E:DEVTYPE=partition\nE:ID_BUS=usb\nE:ID_FS_TYPE=exfat\n");
  add_block("sdb1", "8:17", "E:DEVTYPE=partition\nE:ID_BUS=usb\nE:ID_FS_TYPE=vfat\n");
  add_block("sdc", "8:32", "E:DEVTYPE=disk\nE:ID_BUS=usb\n");
  add_block("nvme0n1p3", "259:3", "E:DEVTYPE=partition\nE:ID_FS_TYPE=erofs\n");
  add_block("sdd", "8:48", "E:DEVTYPE=disk\nE:ID_BUS=usb\n");
  write("sys/class/block/sdd/size", "0\n");  // A card reader without a card.
  const HardwareFacts facts = read_hardware_facts(root_);
  ASSERT_THAT(facts.sticks, SizeIs(2));
  EXPECT_EQ(facts.sticks[0].block, "sda1");
  EXPECT_EQ(facts.sticks[0].file_system, "exfat");
  EXPECT_EQ(facts.sticks[1].block, "sdc");
  EXPECT_EQ(facts.sticks[1].file_system, "");
}

TEST_F(HardwareFactsTest, name_cameras_that_no_driver_takes) {
  add_usb("1-1", "HD Webcam", {{"0e", "01"}, {"0e", "02"}}, "uvcvideo");
  add_usb("1-2", "Odd Webcam", {{"0e", "01"}, {"0e", "02"}, {"01", "01"}}, "");
  add_usb("2-1", "Machine Vision 5MP", {{"ef", "05"}}, "");
  add_usb("2-2", "Keyboard", {{"03", "01"}}, "");
  const HardwareFacts facts = read_hardware_facts(root_);
  ASSERT_THAT(facts.cameras, SizeIs(2));
  EXPECT_EQ(facts.cameras[0].name, "Odd Webcam");
  EXPECT_FALSE(facts.cameras[0].is_industrial);
  EXPECT_EQ(facts.cameras[1].name, "Machine Vision 5MP");
  EXPECT_TRUE(facts.cameras[1].is_industrial);
}

TEST_F(HardwareFactsTest, are_empty_where_nothing_can_be_read) {
  const HardwareFacts facts = read_hardware_facts(root_ / "nowhere");
  EXPECT_THAT(facts.cards, IsEmpty());
  EXPECT_THAT(facts.sticks, IsEmpty());
  EXPECT_THAT(facts.cameras, IsEmpty());
}

Check find(const Findings& findings, std::string_view id) {
  for (const Check& check : checks_of(findings)) {
    if (check.id == id) return check;
  }
  return {"", "not in the list", CheckLevel::kOk, "", ""};
}

Findings with_display(const char* renderer) {
  Findings findings;
  ProcessObservation& display = findings.processes.emplace_back();
  display.endpoint.name = "display";
  display.asked = true;
  display.away = false;
  wire::Fact* const fact = display.status.emplace().add_facts();
  fact->set_name("gl_renderer");
  fact->set_value(renderer);
  return findings;
}

TEST(HardwareChecks, report_a_card_without_a_driver) {
  Findings findings = with_display("Mesa Intel(R) Iris(R) Xe Graphics, OpenGL ES 3.2");
  findings.hardware.cards = {{"Intel", "8086:46a6", "i915"}};
  EXPECT_EQ(find(findings, "graphics").level, CheckLevel::kOk);
  EXPECT_THAT(find(findings, "graphics").sentence, HasSubstr("drawn by Intel (8086:46a6) by i915"));
  EXPECT_EQ(find(findings, "graphics-driver").title, "not in the list");
  findings.hardware.cards.push_back({"NVIDIA", "10de:2684", ""});
  EXPECT_EQ(find(findings, "graphics-driver").level, CheckLevel::kWarning) << "the other one may be used";
  findings.hardware.cards.erase(findings.hardware.cards.begin());
  EXPECT_EQ(find(findings, "graphics-driver").level, CheckLevel::kFault);
  EXPECT_THAT(find(findings, "graphics-driver").sentence, HasSubstr("No driver took NVIDIA (10de:2684)"));
}

TEST(HardwareChecks, report_that_the_processor_draws_although_there_is_a_card) {
  Findings findings = with_display("llvmpipe (LLVM 19.1.7, 256 bits), OpenGL ES 3.2");
  findings.hardware.cards = {{"NVIDIA", "10de:1f08", "nouveau"}};
  EXPECT_EQ(find(findings, "graphics").level, CheckLevel::kWarning);
  EXPECT_THAT(find(findings, "graphics").sentence, HasSubstr("NVIDIA (10de:1f08) by nouveau cannot"));
}

TEST(HardwareChecks, tell_how_a_stick_and_a_camera_have_to_be) {
  Findings findings;
  findings.hardware.sticks = {{"sda1", "exfat"}};
  findings.hardware.cameras = {{"Machine Vision 5MP", true}};
  EXPECT_THAT(find(findings, "stick").sentence, HasSubstr("formatted as exfat"));
  EXPECT_THAT(find(findings, "stick").remedy, HasSubstr("FAT32"));
  EXPECT_THAT(find(findings, "camera-driver").sentence, HasSubstr("USB3 Vision"));
  EXPECT_THAT(find(findings, "camera-driver").remedy, HasSubstr("UVC"));
}

}  // namespace
}  // namespace cyclorama::operations
