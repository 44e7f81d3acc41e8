// SPDX-License-Identifier: Apache-2.0
/// TOML settings, read strictly: every wrong key, unit or value is an error that names file, line and remedy.
///
///   TRY_ASSIGN(Config config, Config::read("installation.toml"));
///   ConfigTable wall = config.root().table("wall");
///   const double radius = wall.number("radius_m", {0.5, 50.0});
///   TRY(config.finish());        // The first mistake in the file, or a key that nobody asked for.
///
/// Reading goes on after a mistake with a harmless value, so that code reads like data; finish() is what decides.
/// Keys carry their unit (`radius_m`, `heading_deg`): a key with another unit is an unknown key, and the error says so.
#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "common/base/result.h"

namespace cyclorama {

/// Closed interval of legal values.
struct Range {
  double min;
  double max;
};

/// One table of a Config, which must outlive it. A value, thread-bound. Asking for a key marks it as known.
class ConfigTable {
 public:
  [[nodiscard]] bool has(std::string_view key) const;

  /// Without a fallback the key is required. Values outside `range`, NaN and wrong types are mistakes.
  double number(std::string_view key, Range range, std::optional<double> fallback = std::nullopt);
  int integer(std::string_view key, Range range, std::optional<int> fallback = std::nullopt);
  bool flag(std::string_view key, std::optional<bool> fallback = std::nullopt);
  std::string text(std::string_view key, std::optional<std::string> fallback = std::nullopt);
  std::string choice(std::string_view key, const std::vector<std::string>& legal,
                     std::optional<std::string> fallback = std::nullopt);
  /// Exactly `count` numbers, or any number of them when `count` is 0.
  std::vector<double> numbers(std::string_view key, std::size_t count, Range range,
                              std::optional<std::vector<double>> fallback = std::nullopt);
  /// A list of points of `dimension` numbers each: [[1, 2], [3, 4]]. Empty when the key is absent.
  std::vector<std::vector<double>> points(std::string_view key, std::size_t dimension, Range range);
  std::vector<std::string> texts(std::string_view key, std::optional<std::vector<std::string>> fallback = std::nullopt);
  /// [key]: an empty table, whose required keys are then missing, when it is absent.
  ConfigTable table(std::string_view key);
  /// [[key]]: none when it is absent.
  std::vector<ConfigTable> tables(std::string_view key);

  /// Records a mistake that only the caller can see, at the key's line (or the table's, when it is absent).
  void refuse(std::string_view key, std::string_view what_and_remedy);
  /// Refuses `old_key` where it is present, and names `new_key`, which replaced it.
  void refuse_renamed(std::string_view old_key, std::string_view new_key);

 private:
  friend class Config;
  struct Node;
  explicit ConfigTable(std::shared_ptr<Node> node);
  std::shared_ptr<Node> node_;
};

/// A parsed file. Move-only, thread-bound.
class Config {
 public:
  /// kNotFound, kSystem  the file cannot be read.     kBadData  not TOML: "site.toml:7:3: ...", or over 1 MiB.
  static Result<Config> read(const std::filesystem::path& path);
  /// `name` stands for the file in errors.
  static Result<Config> parse(std::string_view text, std::string name);

  Config(Config&&) noexcept;
  Config& operator=(Config&&) noexcept;
  ~Config();

  [[nodiscard]] ConfigTable root();
  /// kBadData  "site.toml:7: ..." for the mistake nearest the top, and how many more there are.
  [[nodiscard]] Status finish() const;

 private:
  friend class ConfigTable;
  struct Document;
  explicit Config(std::unique_ptr<Document> document);
  std::unique_ptr<Document> document_;
};

}  // namespace cyclorama
