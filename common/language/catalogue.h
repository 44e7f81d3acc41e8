// SPDX-License-Identifier: Apache-2.0
/// What people read, in their language. Programs write and send English; it is translated where it is shown:
///
///   C++ and pages ──scripts/texts──▶ cyclorama.pot ──▶ de.po, fr.po, … ──msgfmt──▶ Catalogue
///
///   wall, answers of the operator page, alarms:  Catalogue::of("de").sentence("No picture goes to 'left'.")
///   scripts of the page:                         tr("Start") in common/http/page/texts.js, with Catalogue::json()
#pragma once

#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "common/language/sentence_template.h"

namespace cyclorama {

/// The texts of one language. A text that it lacks stays English. Reentrant.
class Catalogue {
 public:
  /// Returns the catalogue of a language such as "de"; of one that is not there, English. It lives as long as the program.
  static const Catalogue& of(std::string_view language);
  /// All languages, English first.
  static const std::vector<Catalogue>& all();

  [[nodiscard]] const std::string& language() const { return language_; }
  /// The language's name in itself: "Deutsch".
  [[nodiscard]] const std::string& name() const { return name_; }
  /// The catalogue as a page reads it (embed_catalogues.py).
  [[nodiscard]] std::string_view json() const { return json_; }

  /// Translates what a program wrote, with its arguments: the whole of it, else each sentence, else the parts of a chain
  /// of errors ("opening the output: no card"). Arguments that are texts of the catalogue are translated, too. What is
  /// unknown stays English.
  [[nodiscard]] std::string sentence(std::string_view english) const { return sentence(english, 0); }

 private:
  struct Entry {
    SentenceTemplate english;
    std::vector<SentenceTemplate> forms;
    bool has_plural = false;
  };
  explicit Catalogue(std::string_view json);
  void add(const std::string& english, const Entry& entry);
  [[nodiscard]] std::string sentence(std::string_view english, int depth) const;
  /// Restricts the arguments with which a template matches.
  enum class Arguments { kWithinASentence, kAny };
  /// Returns false if the text as a whole is not in the catalogue.
  bool translate_whole(std::string_view english, Arguments arguments, int depth, std::string* ret_text) const;
  bool translate_sentences(std::string_view english, int depth, std::string* ret_text) const;
  bool translate_parts(std::string_view english, int depth, std::string* ret_text) const;
  [[nodiscard]] std::string fill(const Entry& entry, std::vector<std::string> arguments, int depth) const;

  std::string language_;
  std::string name_;
  std::string decimal_;
  std::string stop_;   ///< Ends a sentence.
  std::string space_;  ///< Stands between two sentences.
  std::string plural_;
  std::string_view json_;
  std::map<std::string, Entry, std::less<>> whole_;  ///< Texts without arguments.
  std::vector<Entry> templates_;                     ///< Those with arguments; those with the most letters come first.
};

/// Returns the best language for a browser's header Accept-Language, "de-CH,de;q=0.9,en;q=0.5"; empty if it names none of
/// them.
[[nodiscard]] std::string best_language(std::string_view accepted);

}  // namespace cyclorama
