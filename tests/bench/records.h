// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <fstream>
#include <functional>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <utility>

namespace cyclorama {

/// One line of JSON per finished case of a bench, by its key. Cases that are in the file are not run again.
class Records {
 public:
  struct Options {
    std::string file{};    ///< Empty: no file.
    double seconds = 1e9;  ///< No case is started after this time.
    std::string only{};    ///< Only cases whose key begins with this.
  };
  explicit Records(Options options) : options_(std::move(options)) {
    std::ifstream in(options_.file);
    for (std::string line; std::getline(in, line);) {
      const nlohmann::ordered_json record = nlohmann::ordered_json::parse(line, nullptr, false);
      if (record.is_object() && record.contains("key")) known_[record["key"]] = record;
    }
  }

  /// Returns the record of a case, from the file or by running it; nothing if it is excluded or the time is over.
  std::optional<nlohmann::ordered_json> get(const std::string& key,
                                            const std::function<nlohmann::ordered_json()>& run) {
    if (!options_.only.empty() && !key.starts_with(options_.only)) return std::nullopt;
    if (const auto at = known_.find(key); at != known_.end()) return at->second;
    if (std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count() > options_.seconds) {
      is_cut_ = true;
      return std::nullopt;
    }
    nlohmann::ordered_json record = run();
    record["key"] = key;
    if (!options_.file.empty()) std::ofstream(options_.file, std::ios::app) << record.dump() << "\n";
    return record;
  }
  /// Returns 75 (EX_TEMPFAIL) if not all cases were run, so that a later call continues.
  [[nodiscard]] int exit_code() const { return is_cut_ ? 75 : 0; }

 private:
  Options options_;
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
  std::map<std::string, nlohmann::ordered_json> known_;
  bool is_cut_ = false;
};

}  // namespace cyclorama
