// SPDX-License-Identifier: Apache-2.0
#include "appliance/interchange/mpcdi.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <cstring>
#include <string>

#include "appliance/interchange/mask_png.h"
#include "appliance/interchange/zip_archive.h"
#include "common/base/file.h"
#include "common/image/pfm.h"
#include "tests/data_sets/generated_warps.h"

namespace cyclorama::interchange {
namespace {

using ::testing::HasSubstr;
using ::testing::IsEmpty;

std::vector<std::byte> bytes_of(std::string_view text) {
  const auto* const begin = reinterpret_cast<const std::byte*>(text.data());
  return {begin, begin + text.size()};
}

std::vector<std::byte> packed(const std::vector<ZipMember>& members) {
  auto zip = write_zip(members);
  CHECK(zip.has_value());
  return *std::move(zip);
}

constexpr std::string_view kHead = R"(<?xml version="1.0" encoding="utf-8"?>
<MPCDI profile="2d" level="1" date="2013-02-08 11:39:41" version="1.0">
)";
constexpr std::string_view kDisplay = R"(<display>
<buffer id="b" Xresolution="20" Yresolution="10">
<region id="r" Xresolution="4" Yresolution="3" x="0" y="0" xsize="1" ysize="1"/>
</buffer></display>
)";
constexpr std::string_view kFiles = R"(<files><fileset region="r">
<geometryWarpFile><path>w.pfm</path><interpolation>linear</interpolation></geometryWarpFile>
<alphaMap><path>a.png</path><componentDepth>1</componentDepth><bitDepth>16</bitDepth><gammaEmbedded>2.2</gammaEmbedded></alphaMap>
</fileset></files></MPCDI>
)";

std::string with(std::string_view text, std::string_view old, std::string_view now) {
  std::string changed(text);
  const std::size_t at = changed.find(old);
  CHECK(at != std::string::npos);
  return changed.replace(at, old.size(), now);
}

Result<MpcdiFile> read_archive(std::string_view manifest) {
  const auto mask = encode_mask_png(MaskMap(4, 3, 1, 16));
  CHECK(mask.has_value());
  return decode_mpcdi(packed(
      {{"mpcdi.xml", bytes_of(manifest)}, {"w.pfm", encode_pfm(GeneratedWarps(1).map(4, 3, true))}, {"a.png", *mask}}));
}

std::string whole() { return std::string(kHead) + std::string(kDisplay) + std::string(kFiles); }

std::string refusal(std::string_view manifest) {
  const auto file = read_archive(manifest);
  return file ? "" : file.error().message();
}

TEST(Mpcdi, survives_a_round_trip_and_is_rewritten_identically) {
  for (const WarpProfile profile :
       {WarpProfile::k2d, WarpProfile::k3d, WarpProfile::kAdvanced3d, WarpProfile::kShaderLamps}) {
    for (const MpcdiVersion version : {MpcdiVersion::k1_0, MpcdiVersion::k2_0}) {
      for (std::uint32_t seed = 0; seed < 10; ++seed) {
        const WarpSet set = GeneratedWarps(seed).set(profile, version);
        const auto bytes = encode_mpcdi(set);
        ASSERT_TRUE(bytes.has_value()) << bytes.error().message();
        const auto back = decode_mpcdi(*bytes);
        ASSERT_TRUE(back.has_value()) << back.error().message();
        EXPECT_EQ(back->set, set);
        EXPECT_THAT(back->ignored, IsEmpty());
        EXPECT_EQ(*encode_mpcdi(back->set), *bytes);
      }
    }
  }
}

TEST(Mpcdi, writes_the_spelling_of_each_version_and_reads_both) {
  const auto manifest_of = [](MpcdiVersion version) {
    const auto bytes = encode_mpcdi(GeneratedWarps(1).set(WarpProfile::k2d, version));
    auto zip = ZipReader::open(*bytes, 1 << 20);
    const auto xml = zip->read("mpcdi.xml");
    return std::string(reinterpret_cast<const char*>(xml->data()), xml->size());
  };
  EXPECT_THAT(manifest_of(MpcdiVersion::k1_0), HasSubstr("Xresolution="));
  EXPECT_THAT(manifest_of(MpcdiVersion::k1_0), HasSubstr("xsize="));
  // The consortium's own reader, of version 1.0, has this spelling.
  EXPECT_THAT(manifest_of(MpcdiVersion::k1_0), HasSubstr("<originof3DData>"));
  EXPECT_THAT(manifest_of(MpcdiVersion::k2_0), HasSubstr("<originOf3DData>"));
  EXPECT_THAT(manifest_of(MpcdiVersion::k2_0), HasSubstr("xResolution="));
  EXPECT_THAT(manifest_of(MpcdiVersion::k2_0), HasSubstr("xSize="));
  const auto old = read_archive(whole());
  ASSERT_TRUE(old.has_value()) << old.error().message();
  const auto other = read_archive(with(with(whole(), "\"r\" Xresolution", "\"r\" xResolution"), "xsize", "xSize"));
  ASSERT_TRUE(other.has_value()) << other.error().message();
  EXPECT_EQ(old->set, other->set);
  EXPECT_EQ(old->set.buffers[0].width_px, 20);
  EXPECT_EQ(old->set.region("r")->width_px, 4);
  EXPECT_EQ(old->set.region("r")->alpha->gamma, 2.2);
  EXPECT_EQ(old->set.region("nobody"), nullptr);
}

TEST(Mpcdi, reads_poses_from_a_bare_manifest) {
  const auto file = decode_mpcdi(bytes_of(R"(<?xml version="1.0" encoding="utf-8"?>
<MPCDI profile="sl" geometry="2" color="1" date="2018-11-16 19:30:11" version="2.0">
  <display><buffer id="wolf">
    <region id="P1" xResolution="1400" yResolution="1050" x="0" y="0" xsize="1" ysize="1">
      <frustum><yaw>-54.6</yaw><pitch>30</pitch><roll>-35</roll><rightAngle>26.5</rightAngle><leftAngle>-26.6</leftAngle>
        <upAngle>20.5</upAngle><downAngle>-20.5</downAngle></frustum>
      <coordinateFrame><posx>0.99906</posx><posy>-0.70781</posy><posz>-0.70934</posz>
        <yawx>0</yawx><yawy>0</yawy><yawz>-1</yawz><pitchx>1</pitchx><pitchy>0</pitchy><pitchz>0</pitchz>
        <rollx>0</rollx><rolly>1</rolly><rollz>0</rollz></coordinateFrame>
    </region></buffer></display>
  <files></files>
  <fileset region="P1">
    <geometryWarpFile><geometricUnit>m</geometricUnit><originOf3DData>unknown</originOf3DData><path></path></geometryWarpFile>
    <alphaMap><bitDepth>8</bitDepth><path></path></alphaMap>
  </fileset>
  <extensionSet><extension Name="x"/></extensionSet>
</MPCDI>)"));
  ASSERT_TRUE(file.has_value()) << file.error().message();
  const WarpRegion* const region = file->set.region("P1");
  ASSERT_NE(region, nullptr);
  EXPECT_FALSE(region->map.has_value());
  EXPECT_EQ(region->frustum->left_deg, -26.6);
  EXPECT_EQ(region->coordinate_frame->position[2], -0.70934);
  ASSERT_EQ(file->ignored.size(), 1U);
  EXPECT_THAT(file->ignored[0], HasSubstr("mpcdi.xml, line 16, <extensionSet>"));
}

TEST(Mpcdi, treats_the_reference_librarys_misspellings_as_unknown) {
  const auto file = read_archive(with(whole(), "</interpolation>",
                                      "</interpolation><geometricUnit>unkown</geometricUnit>"
                                      "<originof3DData>linear</originof3DData>"));
  ASSERT_TRUE(file.has_value()) << file.error().message();
  EXPECT_EQ(file->set.region("r")->origin, DataOrigin::kUnknown);
  ASSERT_EQ(file->ignored.size(), 1U);
  EXPECT_THAT(file->ignored[0], HasSubstr("'linear'"));
}

TEST(Mpcdi, names_line_and_remedy_of_every_mistake_in_the_manifest) {
  const std::string good = whole();
  ASSERT_EQ(refusal(good), "");
  EXPECT_EQ(refusal(with(good, R"(profile="2d")", R"(profile="4d")")),
            "mpcdi.xml, line 2, <MPCDI>: its profile is '4d'; give 2d, 3d, a3 or sl");
  EXPECT_THAT(refusal(with(good, R"(version="1.0">)", R"(version="3.0">)")), HasSubstr("line 2"));
  EXPECT_THAT(refusal(with(with(good, "<display>", "<screen>"), "</display>", "</screen>")),
              HasSubstr("line 2, <MPCDI>: it has no <display>"));
  EXPECT_THAT(refusal(with(good, R"(id="b" )", "")), HasSubstr("line 4, <buffer>: it has no attribute id"));
  EXPECT_THAT(refusal(with(good, R"(Xresolution="4")", R"(Xresolution="-4")")), HasSubstr("line 5, <region>"));
  EXPECT_THAT(refusal(with(good, R"(Xresolution="4")", "")), HasSubstr("line 5, <region>"));
  EXPECT_THAT(refusal(with(good, R"(x="0")", R"(x="nan")")), HasSubstr("line 5, <region>: its x is 'nan'"));
  EXPECT_THAT(refusal(with(good, R"(x="0")", R"(x="0" X="1")")), HasSubstr("twice"));
  EXPECT_THAT(refusal(with(good, R"(xsize="1")", R"(xsize="1.5")")), HasSubstr("region 'r': its rectangle"));
  EXPECT_THAT(refusal(with(good, R"(fileset region="r")", R"(fileset region="q")")), HasSubstr("no region 'q'"));
  EXPECT_THAT(refusal(with(good, "w.pfm", "../w.pfm")), HasSubstr("line 8, <path>: member '../w.pfm'"));
  EXPECT_THAT(refusal(with(good, "w.pfm", "a.png")), HasSubstr("member 'a.png': byte 0"));
  EXPECT_THAT(refusal(with(good, "a.png", "w.pfm")), HasSubstr("member 'w.pfm': PNG"));
  EXPECT_THAT(refusal(with(good, ">2.2<", ">-1<")), HasSubstr("gamma"));
  EXPECT_THAT(refusal(with(good, ">2.2<", ">much<")), HasSubstr("line 9, <gammaEmbedded>"));
  EXPECT_THAT(refusal(with(good, R"(profile="2d")", R"(profile="3d")")), HasSubstr("frustum"));
  EXPECT_THAT(refusal(with(good, "</fileset>", R"(</fileset><fileset region="r"/>)")), HasSubstr("twice"));
  EXPECT_THAT(refusal(with(good, "<path>w.pfm</path>", "<path>w.pfm</path><Path>w.pfm</Path>")), HasSubstr("twice"));
  EXPECT_THAT(refusal(with(good, "</MPCDI>", "")), HasSubstr("this is no XML"));
  EXPECT_THAT(refusal(""), HasSubstr("this is no XML"));
}

TEST(Mpcdi, refuses_damaged_archives_whichever_byte_is_changed_or_lost) {
  const auto bytes = encode_mpcdi(GeneratedWarps(5).set(WarpProfile::k2d, MpcdiVersion::k2_0));
  ASSERT_TRUE(bytes.has_value());
  for (std::size_t length = 0; length < bytes->size(); length += 1 + length / 50) {
    const auto cut = decode_mpcdi(std::span(*bytes).first(length));
    ASSERT_FALSE(cut.has_value()) << length;
    EXPECT_EQ(cut.error().code(), ErrorCode::kBadData);
  }
  // A changed byte is either reported or changes nothing that is read.
  for (std::size_t at = 0; at < bytes->size(); at += 1 + at / 50) {
    std::vector<std::byte> changed = *bytes;
    changed[at] ^= std::byte{0x40};
    const auto file = decode_mpcdi(changed);
    if (file) {
      EXPECT_EQ(*encode_mpcdi(file->set), *bytes) << at;
    }
  }
}

TEST(Zip, refuses_hostile_archives_by_member) {
  const auto refused = [](const std::vector<ZipMember>& members) {
    const auto bytes = packed(members);
    const auto zip = ZipReader::open(bytes, 1 << 20);
    return zip ? "" : zip.error().message();
  };
  EXPECT_EQ(refused({{"a/b.pfm", {}}, {"c", {}}}), "");
  EXPECT_THAT(refused({{"a/../../b", {}}}), HasSubstr("member 'a/../../b': its name leaves the archive"));
  EXPECT_THAT(refused({{"/etc/passwd", {}}}), HasSubstr("absolute"));
  EXPECT_THAT(refused({{"C:/x", {}}}), HasSubstr("absolute"));
  EXPECT_THAT(refused({{"a\\b", {}}}), HasSubstr("backslash"));
  EXPECT_THAT(refused({{"a\nb", {}}}), HasSubstr("plain text"));
  EXPECT_THAT(refused({{"A.pfm", {}}, {"a.PFM", {}}}), HasSubstr("twice"));
  std::vector<ZipMember> many;
  for (int i = 0; i < 1025; ++i) many.push_back({std::to_string(i), {}});
  EXPECT_THAT(refused(many), HasSubstr("1025 members"));
}

TEST(Zip, refuses_members_larger_than_the_limit_or_than_deflate_allows) {
  const std::vector<std::byte> zeros(std::size_t{1} << 20);
  std::vector<std::byte> bytes = packed({{"zeros", zeros}});
  {
    auto zip = ZipReader::open(bytes, zeros.size() - 1);
    ASSERT_TRUE(zip.has_value());
    EXPECT_THAT(zip->read("zeros").error().message(), HasSubstr("unpacks to 1048576 bytes"));
  }
  {
    auto zip = ZipReader::open(bytes, zeros.size());
    EXPECT_EQ(*zip->read("zeros"), zeros);
    EXPECT_FALSE(zip->read("zeros").has_value()) << "twice is more than the limit";
  }
  // The directory declares four GiB for a member of a thousand bytes.
  const std::uint32_t true_size = 1 << 20;
  const std::uint32_t false_size = 0xfffffff0;
  int claims = 0;
  for (std::size_t i = 0; i + 4 <= bytes.size(); ++i) {
    if (std::memcmp(bytes.data() + i, &true_size, 4) == 0) {
      std::memcpy(bytes.data() + i, &false_size, 4);
      ++claims;
    }
  }
  ASSERT_EQ(claims, 2);
  EXPECT_THAT(ZipReader::open(bytes, std::size_t{8} << 30).error().message(), HasSubstr("claim to unpack"));
}

TEST(Mpcdi, writes_a_file_completely_and_names_it_in_errors) {
  const auto path = std::filesystem::temp_directory_path() / ("mpcdi_test_" + std::to_string(::getpid()) + ".mpcdi");
  const WarpSet set = GeneratedWarps(7).set(WarpProfile::kAdvanced3d, MpcdiVersion::k2_0);
  ASSERT_TRUE(write_mpcdi(path, set).has_value());
  const auto back = read_mpcdi(path);
  ASSERT_TRUE(back.has_value());
  EXPECT_EQ(back->set, set);
  std::filesystem::resize_file(path, 300);
  EXPECT_THAT(read_mpcdi(path).error().message(), HasSubstr(path.string()));
  std::filesystem::remove(path);
  EXPECT_EQ(read_mpcdi(path).error().code(), ErrorCode::kNotFound);
  EXPECT_THAT(write_mpcdi(path, WarpSet()).error().message(), HasSubstr("no buffer"));
}

}  // namespace
}  // namespace cyclorama::interchange
