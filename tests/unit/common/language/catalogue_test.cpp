// SPDX-License-Identifier: Apache-2.0
#include "common/language/catalogue.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace cyclorama {
namespace {

using ::testing::ElementsAre;

TEST(SentenceTemplate, gives_back_the_arguments_that_were_filled_in) {
  const SentenceTemplate text("{:.1f} GB of {:.1f} GB are free.");
  EXPECT_THAT(text.arguments_of("3.0 GB of 64.0 GB are free."), ::testing::Optional(ElementsAre("3.0", "64.0")));
  EXPECT_EQ(text.filled({"3,0", "64,0"}), "3,0 GB of 64,0 GB are free.");
  EXPECT_TRUE(text.is_decimal(0));
  EXPECT_FALSE(text.arguments_of("3.0 GB are free."));
  EXPECT_FALSE(text.arguments_of("3.0 GB of 64.0 GB are free. Really."));
  EXPECT_FALSE(text.arguments_of(""));
}

TEST(SentenceTemplate, takes_arguments_in_another_order_and_braces_as_they_are) {
  EXPECT_EQ(SentenceTemplate("{1}: {0}").filled({"a", "b"}), "b: a");
  EXPECT_EQ(SentenceTemplate("{{\"pin\"}} {}").filled({"x"}), "{\"pin\"} x");
  EXPECT_THAT(SentenceTemplate("'{0}' and '{0}'").arguments_of("'a' and 'a'"), ::testing::Optional(ElementsAre("a")));
  EXPECT_EQ(SentenceTemplate("{} {}").filled({"only one"}), "only one ");
  EXPECT_EQ(SentenceTemplate("an open {").filled({}), "an open {");
}

TEST(Catalogue, knows_its_languages_and_takes_english_for_every_other) {
  std::vector<std::string> languages;
  for (const Catalogue& one : Catalogue::all()) languages.push_back(one.language());
  EXPECT_THAT(languages, ElementsAre("en", "de", "es", "fr", "zh"));
  EXPECT_EQ(Catalogue::of("de").name(), "Deutsch");
  EXPECT_EQ(Catalogue::of("tlh").language(), "en");
  EXPECT_EQ(Catalogue::of("tlh").sentence("Disk"), "Disk");
}

TEST(Catalogue, translates_texts_arguments_and_decimals) {
  const Catalogue& german = Catalogue::of("de");
  EXPECT_EQ(german.sentence("Disk"), "Datenträger");
  EXPECT_EQ(german.sentence("No picture goes to 'left'."), "Kein Bild geht an 'left'.");
  EXPECT_EQ(german.sentence("It sends 19.8 pictures a second."), "Sie liefert 19,8 Bilder pro Sekunde.");
  EXPECT_EQ(german.sentence("Version 0.1 runs."), "Version 0.1 läuft.") << "a version is no decimal number";
  EXPECT_EQ(Catalogue::of("fr").sentence("It answers over IPv6, in 3.1 ms (2.0 to 4.5)."),
            "Elle répond en 3,1 ms par IPv6 (2,0 à 4,5).");
  EXPECT_EQ(Catalogue::of("zh").sentence("2 of 3 projectors are as they should be."), "3 台投影机中有 2 台状态正常。");
}

TEST(Catalogue, takes_the_form_for_the_count) {
  const auto text = [](const char* days) {
    return std::string("It is good until 2029-02-24, ") + days + (std::string(days) == "1" ? " day." : " days.");
  };
  EXPECT_EQ(Catalogue::of("de").sentence(text("1")), "Es gilt bis 2029-02-24, noch 1 Tag.");
  EXPECT_EQ(Catalogue::of("de").sentence(text("0")), "Es gilt bis 2029-02-24, noch 0 Tage.");
  EXPECT_EQ(Catalogue::of("fr").sentence(text("0")), "Il est valable jusqu’au 2029-02-24, encore 0 jour.")
      << "French counts zero as one";
  EXPECT_EQ(Catalogue::of("es").sentence(text("1301")), "Es válido hasta el 2029-02-24, 1301 días más.");
  EXPECT_EQ(Catalogue::of("zh").sentence(text("2")), "有效期至 2029-02-24，还有 2 天。");
}

TEST(Catalogue, translates_sentences_lists_and_chains_of_errors) {
  const Catalogue& german = Catalogue::of("de");
  EXPECT_EQ(german.sentence("Version 2 runs. Version 3 is being fetched."), "Version 2 läuft. Version 3 wird geladen.");
  EXPECT_EQ(german.sentence("It reports: lamp (error), fan (warning)."),
            "Er meldet: Lampe (Fehler), Lüfter (Warnung).");
  EXPECT_EQ(german.sentence("listing the stops: the tour has no stops"),
            "Auflisten der Stationen: der Rundgang hat keine Stationen");
  EXPECT_EQ(german.sentence("The stick of 2026-11-25 was refused, and there are no settings in use. site.toml:2: x."),
            "Der USB-Stick vom 2026-11-25 wurde abgelehnt, und es gelten keine Einstellungen. site.toml:2: x.");
  EXPECT_EQ(Catalogue::of("zh").sentence("Version 2 runs. Version 3 is being fetched."),
            "正在运行版本 2。正在下载版本 3。");
  EXPECT_EQ(german.sentence("Visiting 'The grotto', 19.8 frames a second, 1 display, steered by tag."),
            "Besuch in „The grotto“, 19,8 Bilder pro Sekunde, 1 Anzeige, gesteuert durch den Stab.");
}

TEST(Catalogue, leaves_what_it_does_not_know_in_english) {
  for (const std::string text :
       {"", ".", ": ", "; ", ". . . ", "Nobody wrote this sentence.", "{}", "a: b; c, d. e", "\xff\xfe", "{:.1f}"}) {
    EXPECT_EQ(Catalogue::of("de").sentence(text), text);
  }
  const std::string long_one(100000, '.');
  EXPECT_EQ(Catalogue::of("de").sentence(long_one), long_one);
  std::string chain;
  for (int i = 0; i < 500; ++i) chain += "no: such. thing; ";
  EXPECT_EQ(Catalogue::of("fr").sentence(chain), chain);
}

TEST(BestLanguage, is_the_one_that_a_browser_prefers_among_ours) {
  EXPECT_EQ(best_language("de-CH,de;q=0.9,en;q=0.5"), "de");
  EXPECT_EQ(best_language("it-IT, fr;q=0.8, en;q=0.9"), "en");
  EXPECT_EQ(best_language("ZH-hant"), "zh");
  EXPECT_EQ(best_language("it"), "");
  EXPECT_EQ(best_language(""), "");
  EXPECT_EQ(best_language("de;q=0,fr;q=zero,;;,,"), "");
}

}  // namespace
}  // namespace cyclorama
