// SPDX-License-Identifier: Apache-2.0
/// A parser of Prometheus' text format 0.0.4 that is independent of the writer. An invalid line fails the test.
#pragma once

#include <gtest/gtest.h>

#include <map>
#include <regex>
#include <set>
#include <sstream>
#include <string>

namespace cyclorama {

/// Returns the value of each sample by its name with labels, as written. Each sample must occur once, after the TYPE of
/// its family.
inline std::map<std::string, double> samples_of(const std::string& text) {
  static const std::regex kSample(
      R"re(([a-zA-Z_:][a-zA-Z0-9_:]*)(\{(?:[a-zA-Z_]\w*="(?:[^"\\\n]|\\[\\"n])*",?)*\})? (\S+))re");
  static const std::regex kComment(R"(# (HELP|TYPE) ([a-zA-Z_:][a-zA-Z0-9_:]*) (.+))");
  std::map<std::string, double> samples;
  std::set<std::string> families;
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) {
    std::smatch match;
    if (std::regex_match(line, match, kComment)) {
      const bool is_new = match[1] != "TYPE" || families.insert(match[2]).second;
      EXPECT_TRUE(is_new) << "twice: " << line;
      continue;
    }
    if (!std::regex_match(line, match, kSample)) {
      ADD_FAILURE() << "not a sample: " << line;
      continue;
    }
    const std::string family = std::regex_replace(match[1].str(), std::regex("_(bucket|sum|count)$"), "");
    EXPECT_TRUE(families.contains(family) || families.contains(match[1])) << "no TYPE before " << line;
    EXPECT_TRUE(samples.emplace(match[1].str() + match[2].str(), std::stod(match[3])).second) << "twice: " << line;
  }
  return samples;
}

}  // namespace cyclorama
