// SPDX-License-Identifier: Apache-2.0
#include "appliance/tags/tag_search.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <utility>

namespace cyclorama::tags {
namespace {

/// Margin around a known tag, in tag sizes and at least in pixels: its white border, and the change of a hand's motion
/// from one picture to the next.
constexpr double kMarginShare = 0.5;
constexpr double kMinMarginPx = 12.0;
/// Size from which a tag in the decimated picture is found just as reliably.
constexpr double kPlentyPx = 80.0;
/// libapriltag computes its thresholds from tiles of 4 pixels, of a possibly decimated picture: parts that begin at a
/// multiple of this have the same tiles as the whole picture.
constexpr int kAlignPx = 8;
/// Tiles overlap by the size of the largest tag that decimation may hide.
constexpr int kTileOverlapPx = 24;

Eigen::AlignedBox2d box_of(const TagDetection& tag) {
  Eigen::AlignedBox2d box;
  for (const Eigen::Vector2d& corner : tag.corners) box.extend(corner);
  return box;
}

int aligned(int pixel) { return pixel / kAlignPx * kAlignPx; }

/// Returns the box as whole pixels, clipped to the picture.
PixelRect pixels_of(const Eigen::AlignedBox2d& box, int width, int height) {
  const auto cut = [](double value, int max) { return static_cast<int>(std::clamp(value, 0.0, 1.0 * max)); };
  const int left = aligned(cut(std::floor(box.min().x()), width));
  const int top = aligned(cut(std::floor(box.min().y()), height));
  return {left, top, cut(std::ceil(box.max().x()), width) - left, cut(std::ceil(box.max().y()), height) - top};
}

struct Part {
  PixelRect pixels;
  double decimate;
};

Part around(const Part& a, const Part& b) {
  const int left = std::min(a.pixels.x, b.pixels.x);
  const int top = std::min(a.pixels.y, b.pixels.y);
  const int right = std::max(a.pixels.x + a.pixels.width, b.pixels.x + b.pixels.width);
  const int bottom = std::max(a.pixels.y + a.pixels.height, b.pixels.y + b.pixels.height);
  return {{left, top, right - left, bottom - top}, std::min(a.decimate, b.decimate)};
}

/// Joins parts until no two parts would cost less as one.
void join(std::vector<Part>* parts) {
  for (std::size_t i = 0; i < parts->size(); ++i) {
    for (std::size_t j = i + 1; j < parts->size(); ++j) {
      const Part both = around((*parts)[i], (*parts)[j]);
      if (both.pixels.area() > (*parts)[i].pixels.area() + (*parts)[j].pixels.area()) continue;
      (*parts)[i] = both;
      parts->erase(parts->begin() + static_cast<std::ptrdiff_t>(j));
      i = static_cast<std::size_t>(-1);  // Starts over, since the larger part may overlap others.
      break;
    }
  }
}

Eigen::Vector2d centre_of(const TagDetection& tag) {
  return 0.25 * (tag.corners[0] + tag.corners[1] + tag.corners[2] + tag.corners[3]);
}

double size_of(const TagDetection& tag) { return std::sqrt(0.5 * std::max(0.0, doubled_area_px2(tag.corners))); }

/// True if both detections are the same tag at the same position. Two tags with the same id at different positions are
/// two wands, or a tag and its reflection.
bool is_same(const TagDetection& a, const TagDetection& b) {
  return a.id == b.id && (centre_of(a) - centre_of(b)).norm() < 0.5 * std::max(size_of(a), size_of(b));
}

PixelRect tile_of(int index, int width, int height) {
  const int row = index / TagSearch::kTilesAcross;
  const int column = index % TagSearch::kTilesAcross;
  const auto edge = [](int i, int length) { return i * length / TagSearch::kTilesAcross; };
  const int left = aligned(std::max(0, edge(column, width) - kTileOverlapPx));
  const int top = aligned(std::max(0, edge(row, height) - kTileOverlapPx));
  return {left, top, std::min(width, edge(column + 1, width) + kTileOverlapPx) - left,
          std::min(height, edge(row + 1, height) + kTileOverlapPx) - top};
}

}  // namespace

Result<TagSearch> TagSearch::create(const DetectorSettings& settings) {
  TRY_ASSIGN(TagDetector detector, TagDetector::create(settings));
  return TagSearch(std::move(detector), settings);
}

Status TagSearch::add_from(const GreyImage& picture, const PixelRect& part, double decimate,
                           std::vector<TagDetection>* ret_found) {
  TRY_ASSIGN(const std::vector<TagDetection> more, detector_.detect_in(picture, part, decimate));
  for (const TagDetection& tag : more) {
    // Keeps the first detection of a tag, since it was found at full resolution.
    const bool has = std::any_of(ret_found->begin(), ret_found->end(),
                                 [&](const TagDetection& found) { return is_same(found, tag); });
    if (!has) ret_found->push_back(tag);
  }
  return Done{};
}

bool TagSearch::all_known_are_in(const std::vector<TagDetection>& found) const {
  return !known_.empty() && !found.empty() && std::all_of(known_.begin(), known_.end(), [&](const Known& known) {
    // A tag that is missing for some pictures is covered or has left; the search at its last position and in tiles
    // continues.
    return known.missed > 2 ||
           std::any_of(found.begin(), found.end(), [&](const TagDetection& tag) { return tag.id == known.tag.id; });
  });
}

void TagSearch::remember(const std::vector<TagDetection>& found) {
  std::vector<Known> next;
  std::vector<bool> used(known_.size(), false);
  for (const TagDetection& tag : found) {
    std::size_t nearest = known_.size();
    double distance = 0.0;
    for (std::size_t i = 0; i < known_.size(); ++i) {
      if (used[i] || known_[i].tag.id != tag.id) continue;
      const double d = (centre_of(known_[i].tag) - centre_of(tag)).norm();
      if (nearest == known_.size() || d < distance) {
        nearest = i;
        distance = d;
      }
    }
    Known known{tag, Eigen::Vector2d::Zero(), 0};
    if (nearest < known_.size()) {
      used[nearest] = true;
      known.step = (centre_of(tag) - centre_of(known_[nearest].tag)) / (known_[nearest].missed + 1);
    }
    next.push_back(known);
  }
  for (std::size_t i = 0; i < known_.size(); ++i) {
    if (used[i] || known_[i].missed + 1 >= kRemembered) continue;
    next.push_back({known_[i].tag, Eigen::Vector2d::Zero(), known_[i].missed + 1});
  }
  known_ = std::move(next);
}

Result<std::vector<TagDetection>> TagSearch::search(const GreyImage& picture) {
  const PixelRect whole{0, 0, picture.width(), picture.height()};
  if (!tiles_ || decimate_ <= 1.0) return detector_.detect_in(picture, whole, decimate_);
  if (picture.width() != width_px_ || picture.height() != height_px_) known_.clear();
  width_px_ = picture.width();
  height_px_ = picture.height();

  std::vector<Part> parts;
  for (const Known& known : known_) {
    Eigen::AlignedBox2d box = box_of(known.tag);
    const double margin = std::max(kMinMarginPx, kMarginShare * size_of(known.tag)) + 0.5 * known.step.norm();
    box.translate(known.step);
    box.min().array() -= margin;
    box.max().array() += margin;
    const PixelRect pixels = pixels_of(box, picture.width(), picture.height());
    if (!pixels.empty()) parts.push_back({pixels, std::clamp(size_of(known.tag) / kPlentyPx, 1.0, decimate_)});
  }
  join(&parts);
  const int job = next_job_;
  next_job_ = (next_job_ + 1) % kJobs;
  const bool whole_is_due = job % (kJobs / 2) == 0;
  if (!whole_is_due) {
    // Two of the jobs are not tiles; their indices are skipped.
    parts.push_back({tile_of(job - 1 - job / (kJobs / 2), picture.width(), picture.height()), 1.0});
  }

  std::vector<TagDetection> found;
  for (const Part& part : parts) TRY(add_from(picture, part.pixels, part.decimate, &found));
  if (whole_is_due || !all_known_are_in(found)) TRY(add_from(picture, whole, decimate_, &found));
  sort_by_size(&found);
  remember(found);
  return found;
}

}  // namespace cyclorama::tags
