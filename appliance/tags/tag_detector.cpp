// SPDX-License-Identifier: Apache-2.0
#include "appliance/tags/tag_detector.h"

extern "C" {
#include <apriltag/apriltag.h>
#include <apriltag/tag16h5.h>
#include <apriltag/tag25h9.h>
#include <apriltag/tag36h10.h>
#include <apriltag/tag36h11.h>
#include <apriltag/tagCircle21h7.h>
#include <apriltag/tagCircle49h12.h>
#include <apriltag/tagCustom48h12.h>
#include <apriltag/tagStandard41h12.h>
#include <apriltag/tagStandard52h13.h>
}

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "appliance/tags/corner_refinement.h"
#include "common/base/check.h"

namespace cyclorama::tags {
namespace {

struct Family {
  const char* name;
  apriltag_family_t* (*create)();
  void (*destroy)(apriltag_family_t*);
};
constexpr std::array kFamilies{Family{"tag36h11", tag36h11_create, tag36h11_destroy},
                               Family{"tag25h9", tag25h9_create, tag25h9_destroy},
                               Family{"tag16h5", tag16h5_create, tag16h5_destroy},
                               Family{"tag36h10", tag36h10_create, tag36h10_destroy},
                               Family{"tagStandard41h12", tagStandard41h12_create, tagStandard41h12_destroy},
                               Family{"tagStandard52h13", tagStandard52h13_create, tagStandard52h13_destroy},
                               Family{"tagCircle21h7", tagCircle21h7_create, tagCircle21h7_destroy},
                               Family{"tagCircle49h12", tagCircle49h12_create, tagCircle49h12_destroy},
                               Family{"tagCustom48h12", tagCustom48h12_create, tagCustom48h12_destroy}};

/// Upper bound of libapriltag's table of a family's codes, including those with wrong bits.
constexpr std::size_t kMaxTableBytes = std::size_t{64} << 20;

/// Returns the size of libapriltag's table: three slots of 16 bytes for each code and each set of up to `max_hamming`
/// wrong bits.
std::size_t table_bytes(const apriltag_family_t& tags, int max_hamming) {
  const std::size_t bits = tags.nbits;
  std::size_t ways = 1;
  if (max_hamming >= 1) ways += bits;
  if (max_hamming >= 2) ways += bits * (bits - 1) / 2;
  return tags.ncodes * ways * 3 * 16;
}

/// Minimum side of a picture that is searched. A tag has at least this many cells, and libapriltag divides its picture
/// into tiles of 4 pixels, of which at least one must exist.
constexpr double kMinSidePx = 8.0;

struct DestroyDetections {
  void operator()(zarray_t* detections) const { apriltag_detections_destroy(detections); }
};

/// Returns the corners in TagDetection's order: libapriltag's run anticlockwise from the lower left. Its pixel centres
/// are at (0.5, 0.5), like Cyclorama's. The test "a_corner_lands_where_it_was_painted" checks both.
std::array<Eigen::Vector2d, 4> corners_of(const apriltag_detection_t& found) {
  const auto corner = [&](int i) { return Eigen::Vector2d(found.p[i][0], found.p[i][1]); };
  return {corner(3), corner(2), corner(1), corner(0)};
}

/// Returns a decimation that libapriltag performs exactly: it decimates by 1.5 or a whole number, but scales its
/// corners back by the requested value.
float possible_decimation(double wanted) {
  if (wanted >= 2.0) return static_cast<float>(std::floor(wanted));
  return wanted >= 1.5 ? 1.5f : 1.0f;
}

}  // namespace

const std::vector<std::string>& tag_families() {
  static const std::vector<std::string> names = [] {
    std::vector<std::string> list;
    for (const Family& family : kFamilies) list.emplace_back(family.name);
    return list;
  }();
  return names;
}

double doubled_area_px2(const std::array<Eigen::Vector2d, 4>& corners) {
  const Eigen::Vector2d a = corners[2] - corners[0];
  const Eigen::Vector2d b = corners[3] - corners[1];
  return a.x() * b.y() - a.y() * b.x();
}

struct TagDetector::Library {
  const Family* family = nullptr;
  apriltag_family_t* tags = nullptr;
  apriltag_detector_t* detector = nullptr;

  explicit Library(const Family& chosen)
      : family(&chosen), tags(chosen.create()), detector(apriltag_detector_create()) {}
  ~Library() {
    apriltag_detector_destroy(detector);
    family->destroy(tags);
  }
  Library(const Library&) = delete;
  Library& operator=(const Library&) = delete;
};

Result<TagDetector> TagDetector::create(const DetectorSettings& settings) {
  const auto refuse = [](std::string what) { return Error(ErrorCode::kInvalidArgument, std::move(what)); };
  if (!(settings.decimate >= 1.0 && settings.decimate <= 8.0)) return refuse("decimate must be 1 to 8");
  if (settings.threads < 1 || settings.threads > 16) return refuse("threads must be 1 to 16");
  if (settings.max_hamming < 0 || settings.max_hamming > 2) return refuse("max_hamming must be 0, 1 or 2");
  const auto* const family = std::find_if(kFamilies.begin(), kFamilies.end(),
                                          [&](const Family& known) { return settings.family == known.name; });
  if (family == kFamilies.end()) {
    return refuse(
        fmt::format("no tag family '{}'; the families are {}", settings.family, fmt::join(tag_families(), ", ")));
  }
  auto library = std::make_unique<Library>(*family);
  const std::size_t bytes = table_bytes(*library->tags, settings.max_hamming);
  if (bytes > kMaxTableBytes) {
    return refuse(fmt::format("{} has {} codes, so max_hamming = {} takes {} MiB, more than {}; choose a smaller one",
                              settings.family, library->tags->ncodes, settings.max_hamming, bytes >> 20,
                              kMaxTableBytes >> 20));
  }
  apriltag_detector_add_family_bits(library->detector, library->tags, settings.max_hamming);
  library->detector->nthreads = settings.threads;
  library->detector->quad_decimate = possible_decimation(settings.decimate);
  library->detector->refine_edges = settings.refine_edges;
  return TagDetector(std::move(library), settings);
}

TagDetector::TagDetector(std::unique_ptr<Library> library, DetectorSettings settings)
    : library_(std::move(library)), settings_(std::move(settings)) {}
TagDetector::TagDetector(TagDetector&&) noexcept = default;
TagDetector& TagDetector::operator=(TagDetector&&) noexcept = default;
TagDetector::~TagDetector() = default;

Result<std::vector<TagDetection>> TagDetector::detect(const GreyImage& picture) {
  return detect_in(picture, {0, 0, picture.width(), picture.height()}, settings_.decimate);
}

Result<std::vector<TagDetection>> TagDetector::detect_in(const GreyImage& picture, const PixelRect& part,
                                                         double decimate) {
  CHECK(decimate >= 1.0 && decimate <= 8.0);
  std::vector<TagDetection> tags;
  const int left = std::clamp(part.x, 0, picture.width());
  const int top = std::clamp(part.y, 0, picture.height());
  const int width = std::min(part.width, picture.width() - left);
  const int height = std::min(part.height, picture.height() - top);
  if (std::min(width, height) < kMinSidePx * decimate) return tags;
  if (std::max(width, height) > kMaxSidePx) {
    return Error(ErrorCode::kInvalidArgument,
                 fmt::format("a picture of {}x{} pixels; the longest side that can be searched is {}", width, height,
                             kMaxSidePx));
  }
  // libapriltag only reads the picture, but its type lacks const.
  image_u8_t view = {width, height, picture.width(), const_cast<std::uint8_t*>(picture.at(left, top))};
  library_->detector->quad_decimate = possible_decimation(decimate);
  const std::unique_ptr<zarray_t, DestroyDetections> found(apriltag_detector_detect(library_->detector, &view));
  const Eigen::Vector2d origin(left, top);
  for (int i = 0; i < zarray_size(found.get()); ++i) {
    apriltag_detection_t* detection = nullptr;
    zarray_get(found.get(), i, &detection);
    TagDetection tag{detection->id, detection->hamming, static_cast<double>(detection->decision_margin),
                     corners_of(*detection)};
    const bool finite =
        std::all_of(tag.corners.begin(), tag.corners.end(), [](const auto& c) { return c.allFinite(); });
    if (!finite || !(tag.margin >= settings_.min_margin)) continue;
    for (Eigen::Vector2d& corner : tag.corners) corner += origin;
    if (settings_.refine_corners) {
      const TagBorder border = library_->tags->reversed_border ? TagBorder::kWhite : TagBorder::kBlack;
      const RefinedCorners refined = refine_corners(picture, tag.corners, library_->tags->width_at_border, border);
      tag.corners = refined.positions;
      tag.covariance = refined.covariance;
    }
    tags.push_back(tag);
  }
  sort_by_size(&tags);
  return tags;
}

void sort_by_size(std::vector<TagDetection>* tags) {
  std::sort(tags->begin(), tags->end(), [](const TagDetection& a, const TagDetection& b) {
    return doubled_area_px2(a.corners) > doubled_area_px2(b.corners);
  });
}

}  // namespace cyclorama::tags
