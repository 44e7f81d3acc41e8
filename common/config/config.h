// SPDX-License-Identifier: Apache-2.0
/// TOML settings, read strictly: every wrong key, unit or value is an error that names file, line and remedy.
///
///   TRY_ASSIGN(Config config, Config::read("installation.toml"));
///   ConfigTable wall = config.root().table("wall");
///   const double radius = wall.number("radius_m", {0.5, 50.0});
///   TRY(config.finish());        // The first mistake in the file, or a key that was never requested.
///
/// After a mistake, reading continues with a harmless value, so that code needs no branches; finish() returns the
/// error. Keys contain their unit (`radius_m`, `heading_deg`). A key with another unit is an unknown key, and its error
/// names the right key.
#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "common/base/result.h"

namespace cyclorama {

/// Closed interval of valid values.
struct Range {
  double min;
  double max;
};

/// One table of a Config, which must outlive the table. A value, thread-bound. Requesting a key marks it as known.
class ConfigTable {
 public:
  [[nodiscard]] bool has(std::string_view key) const;

  /// Reads a number. Without a fallback the key is required. Values outside `range`, NaN and wrong types are mistakes.
  double number(std::string_view key, Range range, std::optional<double> fallback = std::nullopt);
  int integer(std::string_view key, Range range, std::optional<int> fallback = std::nullopt);
  bool flag(std::string_view key, std::optional<bool> fallback = std::nullopt);
  std::string text(std::string_view key, std::optional<std::string> fallback = std::nullopt);
  std::string choice(std::string_view key, const std::vector<std::string>& legal,
                     std::optional<std::string> fallback = std::nullopt);
  /// Reads exactly `count` numbers, or any number of them if `count` is 0.
  std::vector<double> numbers(std::string_view key, std::size_t count, Range range,
                              std::optional<std::vector<double>> fallback = std::nullopt);
  /// Reads a list of points of `dimension` numbers each: [[1, 2], [3, 4]]. Empty if the key is absent.
  std::vector<std::vector<double>> points(std::string_view key, std::size_t dimension, Range range);
  std::vector<std::string> texts(std::string_view key, std::optional<std::vector<std::string>> fallback = std::nullopt);
  /// Returns the table [key]; if it is absent, an empty table, whose required keys are then missing.
  ConfigTable table(std::string_view key);
  /// Returns the tables [[key]]; empty if the key is absent.
  std::vector<ConfigTable> tables(std::string_view key);

  /// Records a mistake that only the caller can detect, at the line of the key, or of the table if the key is absent.
  void refuse(std::string_view key, std::string_view what_and_remedy);
  /// Records a mistake if the file uses a setting's former name `key`; the message gives `new_key`.
  void refuse_renamed(std::string_view key, std::string_view new_key);

 private:
  friend class Config;
  struct Node;
  explicit ConfigTable(std::shared_ptr<Node> node);
  std::shared_ptr<Node> node_;
};

/// A parsed file. Move-only, thread-bound.
class Config {
 public:
  /// Reads a file. Errors: kNotFound or kSystem if the file cannot be read; kBadData if it is not TOML ("site.toml:7:3:
  /// ...") or exceeds 1 MiB.
  static Result<Config> read(const std::filesystem::path& path);
  /// Parses `text`; `name` stands for the file in errors.
  static Result<Config> parse(std::string_view text, std::string name);

  Config(Config&&) noexcept;
  Config& operator=(Config&&) noexcept;
  ~Config();

  [[nodiscard]] ConfigTable root();
  /// Reports mistakes. Errors: kBadData with the topmost mistake ("site.toml:7: ...") and the number of other mistakes.
  [[nodiscard]] Status finish() const;

 private:
  friend class ConfigTable;
  struct Document;
  explicit Config(std::unique_ptr<Document> document);
  std::unique_ptr<Document> document_;
};

}  // namespace cyclorama
