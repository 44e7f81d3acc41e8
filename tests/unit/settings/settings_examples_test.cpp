// SPDX-License-Identifier: Apache-2.0
// Every example of settings in a header or a document is read by the parsers that read the file.
#include "tests/unit/settings/settings_examples.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>

#include "common/base/file.h"

namespace cyclorama {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

namespace fs = std::filesystem;

std::vector<std::string> mistakes_in(std::string_view text, const std::string& path) {
  std::vector<std::string> all;
  for (const SettingsExample& example : settings_examples(text, path.ends_with(".md"))) {
    for (std::string& mistake : mistakes_of(example, path)) all.push_back(std::move(mistake));
  }
  return all;
}

TEST(SettingsExamples, in_the_tree_are_read_by_their_parsers) {
  const fs::path source = std::getenv("CYCLORAMA_SOURCE");  // NOLINT(concurrency-mt-unsafe): nobody sets it.
  std::vector<fs::path> files{source / "README.md", source / "CONTRIBUTING.md"};
  for (const char* const folder : {"appliance", "common", "docs", "drivers", "image", "kiosk", "renderfarm", "tests"}) {
    for (const auto& entry : fs::recursive_directory_iterator(source / folder)) {
      const fs::path extension = entry.path().extension();
      if (extension == ".h" || extension == ".proto" || extension == ".md") files.push_back(entry.path());
    }
  }
  std::size_t examples = 0;
  for (const fs::path& file : files) {
    const auto text = read_text_file(file, 1 << 20);
    if (!text) continue;  // CONTRIBUTING.md is not in every package of the sources.
    const std::string path = fs::relative(file, source).string();
    examples += settings_examples(*text, path.ends_with(".md")).size();
    for (const std::string& mistake : mistakes_in(*text, path)) ADD_FAILURE() << mistake;
  }
  EXPECT_GT(examples, 20u);
}

TEST(SettingsExamples, with_a_wrong_key_are_reported_with_their_line) {
  EXPECT_THAT(mistakes_in("# site.toml\n\n```toml\n[walk]\nforward_m_per_s = 1.0\n```\n", "a.md"), IsEmpty());
  EXPECT_THAT(mistakes_in("# site.toml\n\n```toml\n[walk]\nforward_km_per_s = 1.0\n```\n", "a.md"),
              ElementsAre(HasSubstr("a.md:5: walk.forward_km_per_s: is not a setting")));
  EXPECT_THAT(mistakes_in("Text.\n\n    # site.toml\n    [walk]\n    # hop_m = 1.0\n", "a.md"),
              ElementsAre(HasSubstr("in a comment: a.md:5: walk.hop_m: is not a setting")));
  EXPECT_THAT(mistakes_in("/// Text:\n///\n///   # site.toml\n///   [hours]\n///   open = [\"Tue-San\"]\n", "a.h"),
              ElementsAre(HasSubstr("a.h:5")));
  EXPECT_THAT(mistakes_in("/// Text:\n///\n///   # camera\n///   v4l2:?widht_px=640\n", "a.h"),
              ElementsAre(HasSubstr("widht_px")));
}

TEST(SettingsExamples, of_an_unknown_file_are_mistakes) {
  EXPECT_THAT(mistakes_in("## A title\n\n```toml\na = 1\n```\n", "a.md"), ElementsAre(HasSubstr("unknown file")));
  EXPECT_THAT(mistakes_in("Text.\n\n    [walk]\n", "a.md"), ElementsAre(HasSubstr("unknown file")));
  EXPECT_THAT(mistakes_in("///   a = \"b\"\n", "a.h"), ElementsAre(HasSubstr("unknown file")));
  EXPECT_THAT(mistakes_in("///   # other.toml\n///   a = 1\n", "a.h"), ElementsAre(HasSubstr("unknown file")));
  EXPECT_THAT(mistakes_in("///   y = x / clip, at most 1\n///   foo() = 1;\n", "a.h"), IsEmpty());
}

TEST(SettingsExamples, that_are_partial_are_completed) {
  EXPECT_THAT(mistakes_in("    # installation.toml, in part\n    [[projector]]\n    turn_deg = 90\n", "a.md"),
              IsEmpty());
  EXPECT_THAT(mistakes_in("    # installation.toml, in part\n    [[projector]]\n    turn_dge = 90\n", "a.md"),
              ElementsAre(HasSubstr("turn_dge")));
  EXPECT_THAT(mistakes_in("    # installation.toml\n    [[projector]]\n    turn_deg = 90\n", "a.md"),
              ElementsAre(HasSubstr("top_m")));
}

}  // namespace
}  // namespace cyclorama
