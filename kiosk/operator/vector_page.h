// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace cyclorama::operations {

/// A point on a page, in millimetres from its upper left corner.
struct PagePoint {
  double x_mm = 0.0;
  double y_mm = 0.0;
};

/// One page of lines, areas and words for print, drawn at its size on paper. A value.
class VectorPage {
 public:
  /// Precondition: both are positive.
  VectorPage(double width_mm, double height_mm) : width_mm_(width_mm), height_mm_(height_mm) {}

  [[nodiscard]] double width_mm() const { return width_mm_; }
  [[nodiscard]] double height_mm() const { return height_mm_; }

  void line(const std::vector<PagePoint>& points, double thickness_mm, bool dashed = false);
  /// Fills several rectangles (upper left, lower right corner) as one area, without a seam where they touch. `grey` 0
  /// is black.
  void fill(const std::vector<std::pair<PagePoint, PagePoint>>& rectangles, double grey);
  void fill(const std::vector<PagePoint>& polygon, double grey);
  /// Draws text in Helvetica, `height_mm` from line to line, from `at` along its base line. Bytes that are not ASCII
  /// become '?'.
  void text(const PagePoint& at, double height_mm, std::string_view words);

 private:
  friend std::string to_pdf(const std::vector<VectorPage>& pages);
  void add(const PagePoint& point, const char* operation);

  double width_mm_;
  double height_mm_;
  std::string content_;  ///< PDF operators.
};

/// Returns a PDF 1.4 file (ISO 32000-1): one content stream per page, the standard font Helvetica, nothing else.
[[nodiscard]] std::string to_pdf(const std::vector<VectorPage>& pages);

}  // namespace cyclorama::operations
