// SPDX-License-Identifier: Apache-2.0
#include "appliance/display/reach_picture.h"

#include <fmt/format.h>
#include <qrencode.h>

#include <algorithm>
#include <memory>
#include <string>

#include "common/language/catalogue.h"

namespace cyclorama::display {
namespace {

using Colour = TextFont::Colour;

constexpr Colour kGround{10, 12, 18};
constexpr Colour kText{238, 232, 220};
constexpr Colour kQuiet{176, 168, 156};
constexpr Colour kAccent{217, 168, 96};
constexpr Colour kPaper{255, 255, 255};
constexpr Colour kInk{0, 0, 0};

/// Sizes as parts of the unit, which is a 40th of the picture's height, or less in a narrow picture.
constexpr double kUnitsHigh = 40.0;
constexpr double kUnitsWide = 56.0;
constexpr double kQrUnits = 17.0;
constexpr double kGapUnits = 2.0;
constexpr double kTextUnits = 21.0;
constexpr int kQuietModules = 4;  // Required around a QR code (ISO/IEC 18004).
constexpr std::size_t kMaxAddresses = 4;
constexpr std::size_t kFingerprintLine = std::size_t{8} * 3;  // Eight bytes and their colons.

using Qr = std::unique_ptr<QRcode, decltype([](QRcode* code) { QRcode_free(code); })>;

void fill(RgbaImage* picture, int x, int y, int width, int height, const Colour& colour) {
  for (int row = std::max(y, 0); row < std::min(y + height, picture->height()); ++row) {
    for (int column = std::max(x, 0); column < std::min(x + width, picture->width()); ++column) {
      std::ranges::copy(colour, picture->at(column, row));
      picture->at(column, row)[3] = 255;
    }
  }
}

/// Draws a QR code with its quiet zone into a square, in whole pixels for each module.
Status draw_qr(const std::string& text, int x, int y, int side, RgbaImage* picture) {
  const Qr code(QRcode_encodeString(text.c_str(), 0, QR_ECLEVEL_M, QR_MODE_8, 1));
  if (code == nullptr) return Error(ErrorCode::kSystem, "the page's address does not fit into a QR code");
  const int module = std::max(1, side / (code->width + 2 * kQuietModules));
  const int paper = module * (code->width + 2 * kQuietModules);
  const int left = x + (side - paper) / 2;
  const int top = y + (side - paper) / 2;
  fill(picture, left, top, paper, paper, kPaper);
  for (int row = 0; row < code->width; ++row) {
    for (int column = 0; column < code->width; ++column) {
      if ((code->data[row * code->width + column] & 1) == 0) continue;
      fill(picture, left + module * (column + kQuietModules), top + module * (row + kQuietModules), module, module,
           kInk);
    }
  }
  return Done{};
}

/// Lines below each other, each as large as requested, or smaller where it would be too wide.
class Column {
 public:
  Column(const TextFont& font, double unit, int x, int y, RgbaImage* picture)
      : font_(font), unit_(unit), x_(x), y_(y), picture_(*picture) {}

  void line(const std::string& text, double size, const Colour& colour) {
    int size_px = pixels(size);
    const int room = pixels(kTextUnits);
    if (const int wide = font_.width_px(text, size_px); wide > room) size_px = std::max(1, size_px * room / wide);
    y_ += pixels(1.4 * size);
    font_.draw(text, size_px, x_, y_, colour, &picture_);
  }
  void gap(double units) { y_ += pixels(units); }

 private:
  [[nodiscard]] int pixels(double units) const { return std::max(1, static_cast<int>(units * unit_)); }
  const TextFont& font_;
  const double unit_;
  const int x_;
  int y_;
  RgbaImage& picture_;
};

}  // namespace

Result<RgbaImage> reach_picture(const PageReach& reach, const TextFont& font, int width_px, int height_px) {
  RgbaImage picture(width_px, height_px, 255);
  fill(&picture, 0, 0, width_px, height_px, kGround);
  const double unit = std::min(height_px / kUnitsHigh, width_px / kUnitsWide);
  const int left = static_cast<int>((width_px - (kQrUnits + kGapUnits + kTextUnits) * unit) / 2.0);
  const int top = static_cast<int>((height_px - kQrUnits * unit) / 2.0);
  const std::string link = link_of(reach);
  if (!link.empty()) TRY(draw_qr(link, left, top, static_cast<int>(kQrUnits * unit), &picture));
  const Catalogue& language = Catalogue::of(reach.language);
  Column text(font, unit, left + static_cast<int>((kQrUnits + kGapUnits) * unit), top, &picture);
  text.line(reach.name.empty() ? "Cyclorama" : reach.name, 1.8, kText);
  text.gap(0.4);
  if (reach.addresses.empty()) {
    text.line(language.sentence("This computer has no network address."), 0.9, kAccent);
    text.line(language.sentence("Is the network's cable in, and its lamp lit?"), 0.9, kAccent);
  } else {
    text.line(language.sentence("Operator page: scan the code, or enter"), 0.9, kQuiet);
    for (std::size_t i = 0; i < std::min(reach.addresses.size(), kMaxAddresses); ++i) {
      text.line(reach.addresses[i], 1.0, kAccent);
    }
  }
  text.gap(0.4);
  if (!reach.fingerprint.empty()) {
    text.line(language.sentence("SHA-256 of its certificate, to compare:"), 0.8, kQuiet);
    for (std::size_t at = 0; at < reach.fingerprint.size(); at += kFingerprintLine) {
      text.line(reach.fingerprint.substr(at, kFingerprintLine - 1), 0.9, kText);
    }
  }
  text.gap(0.4);
  if (!reach.version.empty()) text.line(language.sentence(fmt::format("Version {}", reach.version)), 0.8, kQuiet);
  return picture;
}

}  // namespace cyclorama::display
