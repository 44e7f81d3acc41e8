// SPDX-License-Identifier: Apache-2.0
// The continuous calibration on simulated museums: selfcal_bench COMMAND CONTENT.png [--quick]. Some commands can run a
// part: selfcal_bench bump CONTENT.png FIRST COUNT small|large, drift CONTENT.png MINUTES STEPS_PER_S small|large, and
// the occlusions with --quick FIRST. trade and quiet accept --records FILE, which keeps each case and does not run it
// again; --seconds S, after which no case is started (the exit code is then 75: continue later); --only PREFIX,
// which runs only cases whose key begins with it; and --json FILE.
#include <fmt/format.h>

#include <cstring>
#include <numbers>
#include <string>

#include "tests/bench/selfcal/selfcal_benches.h"

namespace {

int usage() {
  fmt::print(
      stderr,
      "selfcal_bench bump|quiet|drift|occlusion|constraints|extremes|rooms|cost|pacing|features|pictures|trade CONTENT "
      "[--quick]\n");
  return 2;
}

}  // namespace

int main(int count, char** words) {
  using namespace cyclorama;
  if (count < 3) return usage();
  const std::string command = words[1];
  const bool is_quick = count > 3 && std::strcmp(words[3], "--quick") == 0;
  ShowContent content;
  if (std::strcmp(words[2], "painted") == 0) {
    content = painted_content(6144, 3);
  } else {
    // A full circle with square pixels, as made by `cyclorama-render picture --size 6144x704`.
    auto read = read_content(words[2], std::numbers::pi * 704 / 6144, -std::numbers::pi * 704 / 6144);
    if (!read) {
      fmt::print(stderr, "selfcal_bench: {}\n", read.error().message());
      return 1;
    }
    content = *std::move(read);
  }
  if (command == "bump" && count == 6) {
    return bumps(content, {static_cast<std::uint32_t>(std::stoul(words[3])),
                           static_cast<std::uint32_t>(std::stoul(words[4])), std::strcmp(words[5], "small") == 0});
  }
  if (command == "bump") return bumps(content, is_quick ? BumpSeries{1, 12, true} : BumpSeries{});
  if (command == "drift" && count == 6) {
    return drift(content, {std::stoi(words[3]), std::stoi(words[4]), std::strcmp(words[5], "small") == 0});
  }
  if (command == "drift") return drift(content, is_quick ? DriftSeries{10, 1, true} : DriftSeries{});
  if (command == "occlusion") return occlusion(content, is_quick, is_quick && count > 4 ? std::stoul(words[4]) : 0);
  if (command == "constraints") return constraints(content, is_quick);
  if (command == "extremes") return extremes(content, is_quick);
  if (command == "rooms") return room_extremes(content) ? 0 : 1;
  if (command == "cost") return cost(content, is_quick);
  if (command == "pacing") {
    const auto pacing = measure_pacing(content, is_quick);
    if (!pacing) return 1;
    fmt::print("{:.3f} {:.3f} ms, {:.4f} {:.4f} late\n", pacing->p99_off_ms, pacing->p99_on_ms, pacing->late_off,
               pacing->late_on);
    return 0;
  }
  if (command == "features") return features(content, is_quick);
  if (command == "trade" || command == "quiet") {
    Records::Options options;
    std::string json;
    bool is_short = false;
    for (int i = 3; i < count; ++i) {
      const std::string word = words[i];
      if (word == "--quick") {
        is_short = true;
        continue;
      }
      if (i + 1 == count) return usage();
      const std::string value = words[++i];
      if (word == "--records") {
        options.file = value;
      } else if (word == "--seconds") {
        options.seconds = std::stod(value);
      } else if (word == "--only") {
        options.only = value;
      } else if (word == "--json") {
        json = value;
      } else {
        return usage();
      }
    }
    if (command == "quiet") return quiet(content, is_short, options);
    return trade(content, is_short, options, json);
  }
  if (command == "pictures") return pictures(content, count > 3 ? words[3] : ".");
  return usage();
}
