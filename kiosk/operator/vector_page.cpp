// SPDX-License-Identifier: Apache-2.0
#include "kiosk/operator/vector_page.h"

#include <fmt/format.h>

namespace cyclorama::operations {
namespace {

constexpr double kPointsPerMm = 72.0 / 25.4;
/// Ratio of font size to line distance.
constexpr double kFontShare = 0.75;

std::string escaped(std::string_view words) {
  std::string text;
  for (const char c : words) {
    if (c == '(' || c == ')' || c == '\\') text += '\\';
    text += c >= ' ' && c <= '~' ? c : '?';
  }
  return text;
}

}  // namespace

void VectorPage::add(const PagePoint& point, const char* operation) {
  content_ +=
      fmt::format("{:.4f} {:.4f} {}\n", kPointsPerMm * point.x_mm, kPointsPerMm * (height_mm_ - point.y_mm), operation);
}

void VectorPage::line(const std::vector<PagePoint>& points, double thickness_mm, bool dashed) {
  content_ += fmt::format("{:.4f} w {} d 0 G\n", kPointsPerMm * thickness_mm, dashed ? "[6 4] 0" : "[] 0");
  for (std::size_t i = 0; i < points.size(); ++i) add(points[i], i == 0 ? "m" : "l");
  content_ += "S\n";
}

void VectorPage::fill(const std::vector<std::pair<PagePoint, PagePoint>>& rectangles, double grey) {
  content_ += fmt::format("{:.3f} g\n", grey);
  for (const auto& [above, below] : rectangles) {
    add(above, "m");
    add({below.x_mm, above.y_mm}, "l");
    add(below, "l");
    add({above.x_mm, below.y_mm}, "l");
    content_ += "h\n";
  }
  content_ += "f\n";
}

void VectorPage::fill(const std::vector<PagePoint>& polygon, double grey) {
  content_ += fmt::format("{:.3f} g\n", grey);
  for (std::size_t i = 0; i < polygon.size(); ++i) add(polygon[i], i == 0 ? "m" : "l");
  content_ += "h f\n";
}

void VectorPage::text(const PagePoint& at, double height_mm, std::string_view words) {
  content_ += fmt::format("BT /F1 {:.3f} Tf 0 g\n", kFontShare * kPointsPerMm * height_mm);
  add(at, "Td");
  content_ += fmt::format("({}) Tj ET\n", escaped(words));
}

std::string to_pdf(const std::vector<VectorPage>& pages) {
  std::string file = "%PDF-1.4\n";
  std::vector<std::size_t> places;
  const auto add_object = [&](const std::string& body) {
    places.push_back(file.size());
    file += fmt::format("{} 0 obj\n{}\nendobj\n", places.size(), body);
  };
  constexpr int kFirstPage = 4;  // Follows catalogue, list of pages and font; each page is followed by its content.
  std::string kids;
  for (std::size_t i = 0; i < pages.size(); ++i) kids += fmt::format("{} 0 R ", kFirstPage + 2 * i);
  add_object("<< /Type /Catalog /Pages 2 0 R >>");
  add_object(fmt::format("<< /Type /Pages /Kids [{}] /Count {} >>", kids, pages.size()));
  add_object("<< /Type /Font /Subtype /Type1 /BaseFont /Helvetica >>");
  for (const VectorPage& page : pages) {
    add_object(
        fmt::format("<< /Type /Page /Parent 2 0 R /MediaBox [0 0 {:.3f} {:.3f}] /Contents {} 0 R "
                    "/Resources << /Font << /F1 3 0 R >> >> >>",
                    kPointsPerMm * page.width_mm_, kPointsPerMm * page.height_mm_, places.size() + 2));
    add_object(fmt::format("<< /Length {} >>\nstream\n{}endstream", page.content_.size(), page.content_));
  }
  const std::size_t table = file.size();
  file += fmt::format("xref\n0 {}\n0000000000 65535 f \n", places.size() + 1);
  for (const std::size_t place : places) file += fmt::format("{:010} 00000 n \n", place);
  file += fmt::format("trailer\n<< /Size {} /Root 1 0 R >>\nstartxref\n{}\n%%EOF\n", places.size() + 1, table);
  return file;
}

}  // namespace cyclorama::operations
