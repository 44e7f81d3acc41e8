// SPDX-License-Identifier: Apache-2.0
/// Tests whether a noisy picture has the expected mean, with a z-test of each pixel and one of the whole picture,
/// against the stored mean and variance of a long run. The test of the whole picture detects small biases that no
/// single pixel reveals. Source: Subr and Arvo, "Statistical Hypothesis Testing for Assessing Monte Carlo Estimators",
/// 2007.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <limits>
#include <numbers>
#include <sstream>
#include <string>
#include <vector>

#include "common/base/check.h"
#include "common/base/file.h"
#include "common/image/pfm.h"
#include "renderfarm/render/film.h"
#include "tests/support/statistics.h"

namespace cyclorama {

/// The luminance of a long run: for each pixel, the mean and the variance of one sample. Stratified samples have a
/// smaller variance, which makes the test less sensitive but never causes more false alarms.
struct Golden {
  int width = 0;
  int height = 0;
  double samples = 0.0;  ///< Samples per pixel of the long run.
  std::vector<double> mean;
  std::vector<double> variance;
};

[[nodiscard]] inline double mean_luminance(const render::Film& film, std::size_t pixel) {
  const float* const rgb = &film.sum.data()[3 * pixel];
  return (0.2126 * static_cast<double>(rgb[0]) + 0.7152 * static_cast<double>(rgb[1]) +
          0.0722 * static_cast<double>(rgb[2])) /
         film.samples.data()[pixel];
}

/// Adds up a long run film by film in double precision, because a large float sum loses small samples. Thread-bound.
class GoldenRun {
 public:
  /// Adds a film. Precondition: all films have the same size and the same number of samples in every pixel.
  void add(const render::Film& film) {
    const std::size_t pixels = film.samples.data().size();
    if (sum_.empty()) {
      width_ = film.width();
      height_ = film.height();
      sum_.resize(pixels);
      square_.resize(pixels);
    }
    CHECK(film.width() == width_ && film.height() == height_);
    const int samples = film.samples.data()[0];
    for (std::size_t i = 0; i < pixels; ++i) {
      CHECK(film.samples.data()[i] == samples);
      sum_[i] += mean_luminance(film, i) * samples;
      square_[i] += static_cast<double>(film.square.data()[i]);
    }
    samples_ += samples;
  }
  [[nodiscard]] Golden result() const {
    Golden golden{width_, height_, samples_, {}, {}};
    for (std::size_t i = 0; i < sum_.size(); ++i) {
      const double mean = sum_[i] / samples_;
      golden.mean.push_back(mean);
      golden.variance.push_back(std::max(0.0, square_[i] / samples_ - mean * mean) * samples_ / (samples_ - 1.0));
    }
    return golden;
  }

 private:
  int width_ = 0;
  int height_ = 0;
  double samples_ = 0.0;
  std::vector<double> sum_;
  std::vector<double> square_;
};

/// Returns the text for a file in tests/golden: a comment with the command that reproduces it, then numbers.
[[nodiscard]] inline std::string golden_text(const Golden& golden, const std::string& command) {
  std::ostringstream text;
  text.precision(9);
  text << "# Luminance per pixel, row by row: mean, variance of one sample. First: width, height, samples. Made by:\n# "
       << command << "\n"
       << golden.width << " " << golden.height << " " << golden.samples << "\n";
  for (std::size_t i = 0; i < golden.mean.size(); ++i) text << golden.mean[i] << " " << golden.variance[i] << "\n";
  return text.str();
}

[[nodiscard]] inline Result<Golden> parse_golden(const std::string& text) {
  std::istringstream in(text);
  std::string comment;
  while (in.peek() == '#') std::getline(in, comment);
  Golden golden;
  in >> golden.width >> golden.height >> golden.samples;
  constexpr int kMaxSidePx = 4096;
  const bool sized =
      in && golden.width > 0 && golden.height > 0 && golden.width <= kMaxSidePx && golden.height <= kMaxSidePx;
  for (int i = 0; sized && i < golden.width * golden.height; ++i) {
    golden.mean.push_back(0.0);
    golden.variance.push_back(0.0);
    in >> golden.mean.back() >> golden.variance.back();
  }
  if (sized && in && golden.samples >= 2.0 && (in >> std::ws).eof()) return golden;
  return Error(ErrorCode::kBadData, "not a golden picture: make it again with the command in its second line");
}

/// Returns the path of tests/golden/`name`.txt in the repository.
[[nodiscard]] inline std::filesystem::path golden_path(const std::string& name) {
  const char* const source = std::getenv("CYCLORAMA_SOURCE");
  return std::filesystem::path(source == nullptr ? "." : source) / "tests/golden" / (name + ".txt");
}

struct ZTest {
  /// Significance level of each test, with which all tests together raise a false alarm with probability alpha.
  double level = 0.0;
  double worst_p = 1.0;  ///< p-value of the least likely pixel.
  std::size_t worst_pixel = 0;
  double picture_p = 1.0;  ///< p-value of the sum over all pixels.
  std::vector<double> z;   ///< z of each pixel, positive if the film is too bright there; infinite for NaN.
  [[nodiscard]] bool passed() const { return worst_p >= level && picture_p >= level; }
};

/// Tests a film. Each pixel needs enough samples for a nearly normal mean. Precondition: the sizes are equal.
[[nodiscard]] inline ZTest z_test(const render::Film& film, const Golden& golden, double alpha = 0.01) {
  CHECK(film.width() == golden.width && film.height() == golden.height);
  const auto p_of = [](double z) { return std::erfc(std::abs(z) / std::numbers::sqrt2); };
  ZTest test;
  test.level = sidak(alpha, static_cast<int>(golden.mean.size()) + 1);
  double difference = 0.0;
  double variance = 0.0;
  for (std::size_t i = 0; i < golden.mean.size(); ++i) {
    const double n = film.samples.data()[i];
    const double mean = mean_luminance(film, i);
    // A sum of n floats may be off by n rounding errors, here and in each film of the long run. Without this term, a
    // pixel without variance would fail.
    const double rounding = n * std::numeric_limits<float>::epsilon() * golden.mean[i];
    const double pixel = golden.variance[i] * (1.0 / n + 1.0 / golden.samples) + rounding * rounding;
    const double gap = mean - golden.mean[i];
    double z = gap == 0.0 ? 0.0 : gap / std::sqrt(pixel);
    if (std::isnan(z)) z = std::numeric_limits<double>::infinity();
    test.z.push_back(z);
    if (p_of(z) < test.worst_p) {
      test.worst_p = p_of(z);
      test.worst_pixel = i;
    }
    difference += gap;
    variance += pixel;
  }
  test.picture_p = difference == 0.0 ? 1.0 : p_of(difference / std::sqrt(variance));
  if (std::isnan(test.picture_p)) test.picture_p = 0.0;
  return test;
}

/// Compares a film with tests/golden/`name`.txt. A failure names the pixel, and writes the picture and z as PFM files.
inline void expect_golden(const render::Film& film, const std::string& name) {
  const std::filesystem::path path = golden_path(name);
  const auto text = read_text_file(path, 1 << 22);
  ASSERT_TRUE(text) << text.error().message();
  const auto golden = parse_golden(*text);
  ASSERT_TRUE(golden) << name << ": " << golden.error().message();
  const ZTest test = z_test(film, *golden);
  if (test.passed()) return;
  RadianceImage z(golden->width, golden->height);
  for (std::size_t i = 0; i < z.data().size(); ++i) z.data()[i] = static_cast<float>(test.z[i / 3]);
  const std::string at = testing::TempDir() + "/" + name;
  EXPECT_TRUE(write_pfm(at + ".z.pfm", z) && write_pfm(at + ".mean.pfm", film.mean()));
  const auto width = static_cast<std::size_t>(golden->width);
  ADD_FAILURE() << name << ": pixel (" << test.worst_pixel % width << ", " << test.worst_pixel / width
                << ") has p = " << test.worst_p << ", the whole picture " << test.picture_p << "; at least "
                << test.level << " is chance. See " << at << ".z.pfm";
}

}  // namespace cyclorama
