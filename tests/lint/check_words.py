#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Fails on words that a newcomer stumbles over. tests/lint/words.toml holds the tables; each rule can be run alone:

  fragments      a comment's paragraph begins with "Of", "What", "Where" ... and has no main verb
  inner          the same of a later sentence in a paragraph
  limits         a limit is called kMost..., kLeast..., ...Patience
  private        a word of our own has taken the place of the field's, in a name, a comment or a text
  spoken         people's verbs where a comment or a document states a fact
  spoken_names   the same in names
  types          two types have the same full name

What counts as a main verb is a guess that is cheap and errs towards a report. Only what stands before the first colon
or semicolon counts, without the clauses that a relative or a conjunction opens. After "Of" and "By" one finite verb
must be left; after "What", "Whether", "Who" ... two before the first comma, the clause's and the sentence's ("That
costs ..." needs one); after "As", "Where", "When" ... a clause must follow the comma. Finite verbs are those of a
list.

Run: check_words.py [SOURCE_ROOT] [--rules R,R] [--under FOLDER] [--count] [--show]
  --count  prints the number of reports per rule and folder and succeeds; with --show also the reports
"""
import argparse
import collections
import pathlib
import re
import subprocess
import sys
import tomllib

import cxx_text

HERE = pathlib.Path(__file__).resolve().parent
TEXT = {".h", ".cpp", ".proto", ".py", ".js", ".html", ".css", ".md", ".toml", ".sh", ".txt", ".service", ".socket",
        ".timer", ".target", ".conf", ".in", ""}
LEFT_OUT = re.compile(r"^(tests/fuzz/(corpus|keep)/|tests/golden/|LICENSE|\.git)|\.(patch|svg)$")
NAMES_OLD_WORDS = re.compile(r"^(docs/glossary\.md|CHANGELOG\.md|tests/lint/(words\.toml|check_words\w*\.py))$")
CXX = {".h", ".cpp", ".proto"}
PRODUCT = ("common/", "drivers/", "renderfarm/", "appliance/", "kiosk/", "tests/data_sets/", "tests/doubles/",
           "tests/support/")


class Tree:
    """The tracked files of a source tree; without git all its files."""

    def __init__(self, root, under):
        self.root = pathlib.Path(root)
        listed = subprocess.run(["git", "-C", root, "ls-files", "--cached", "--others", "--exclude-standard"],
                                capture_output=True, text=True, check=False)
        names = listed.stdout.split("\n")
        if listed.returncode != 0:
            names = [f.relative_to(root).as_posix() for f in self.root.rglob("*")]
        self.names = sorted({n for n in names if n and (self.root / n).is_file() and not (self.root / n).is_symlink()})
        self.under = under.strip("/") if under else ""

    def wanted(self, name):
        return not self.under or name == self.under or name.startswith(self.under + "/")

    def read(self, name):
        try:
            return (self.root / name).read_text(encoding="utf-8")
        except UnicodeDecodeError:
            return ""

    def of(self, suffixes):
        for name in self.names:
            if self.wanted(name) and not LEFT_OUT.search(name) and pathlib.PurePosixPath(name).suffix in suffixes:
                yield name, self.read(name)


# --- fragments ---

SUBORDINATE = re.compile(r"\b(that|which|who|whom|whose|what|where|when|if|while|until|unless|because|whether|how"
                         r"|whoever|whatever|so that|than|before|after|since|as)\b[^,;:]*")
MODALS = "may|might|can|cannot|must|should|would|will|shall|could|do|does|did"


def plain_words(text):
    """`text` up to its first colon or semicolon, without code and parentheses; a chain of auxiliaries is one word."""
    plain = re.sub(r"`[^`]*`|\w+\([^)]*\)|\w+(::\w+)+", "X", text)
    plain = re.sub(r"\([^)]*\)|\[[^]]*\]", " ", plain)
    plain = re.split(r"[:;]", plain)[0]
    return re.sub(rf"\b({MODALS}|has|have|had)( not| never)? \w+|\b(is|are|was|were) to \w+", lambda m: m[1] or m[3],
                  plain)


def finite_verbs(text, verbs):
    """How many finite verbs stand in `text` outside the clauses that relatives and conjunctions open."""
    return sum(w in verbs for w in re.findall(r"[A-Za-z']+", SUBORDINATE.sub(" ", text)))


def may_have_verb(text, verbs):
    """As finite_verbs(), but takes any word in -s for a verb, and a clause of three words for a whole one."""
    words = re.findall(r"[A-Za-z']+", SUBORDINATE.sub(" ", text))
    return len(words) >= 3 or any(w in verbs or re.fullmatch(r"[a-z]{3,}s", w) for w in words)


def is_fragment(sentence, table, verbs):
    opener = re.match(r"[A-Z][a-z]+\b", sentence)
    if not opener or sentence.rstrip().endswith("?"):
        return False
    word, rest = opener[0], plain_words(sentence[opener.end():])
    if word in table["prepositions"]:
        return not finite_verbs(rest, verbs)
    if word in table["nominal"]:
        if word == "That" and re.match(r" [a-z]+s\b| (can|may|must|will|would)\b", rest):
            return False  # "That costs nothing": it points at something.
        if word == "However" and rest.startswith(","):
            return False
        return finite_verbs(rest.split(",")[0], verbs) < 2
    if word in table["clauses"]:
        if sentence.rstrip().endswith(":"):
            return False  # An example follows.
        if re.match(r" (many|much|long|soon|far) ", rest):
            return not may_have_verb(rest, verbs)
        after = rest.split(",", 1)
        return len(after) < 2 or bool(re.match(r" (or|and) ", after[1])) or not may_have_verb(after[1], verbs)
    return False


def fragments(tree, tables, inner=False):
    table = tables["fragments"]
    verbs = set(table["verbs"].split())
    for name, text in tree.of(CXX):
        for line, paragraph in cxx_text.paragraphs(text):
            sentences = re.split(r"(?<=[a-z0-9)`][.!?])\s+(?=[A-Z])", paragraph)
            for sentence in sentences[1:] if inner else sentences[:1]:
                if is_fragment(sentence, table, verbs):
                    yield name, line, sentence[:110]


# --- names and words ---

def limits(tree, tables):
    row = tables["limits"]
    name_of_limit = re.compile(rf"{row['identifier']}")
    for name, text in tree.of(CXX | {".py", ".js"}):
        if NAMES_OLD_WORDS.match(name):
            continue
        for number, line in enumerate(text.split("\n"), 1):
            for match in name_of_limit.finditer(line):
                is_name = match[0][0] == "k" or "_" in match[0] or match[0] != match[0].lower()
                if is_name and match[0] not in row["allowed"]:
                    yield name, number, match[0]


NAME = re.compile(r"[A-Za-z_][A-Za-z0-9_]*")
TEST_NAME = re.compile(r"\s*TEST(_F|_P)?\(")
RENAMED = re.compile(r"[Rr]enamed|is now called|is called '\w+' now")
HUMP = re.compile(r"(?<=[a-z0-9])(?=[A-Z])|(?<=[A-Z])(?=[A-Z][a-z])|[_\-/]+")


def parts(text):
    return " ".join(HUMP.sub(" ", text).lower().split())


def words(tree, rows):
    compiled = [(re.compile(rf"\b{r['word']}(?!\w)"), r, re.compile(r.get("unless", "$.^"))) for r in rows]
    for name, text in tree.of(TEXT):
        if NAMES_OLD_WORDS.match(name):
            continue
        near = [c for c in compiled if "under" not in c[1] or any(name.startswith(f + "/") for f in c[1]["under"])]
        for number, line in [(0, name)] + list(enumerate(text.split("\n"), 1)):
            if len(line) > 4000 or RENAMED.search(line):
                continue
            plain = parts(line)
            names = None
            for word, row, unless in near:
                if not word.search(plain) or unless.search(line):
                    continue
                if row.get("in") == "identifiers":
                    if TEST_NAME.match(line):
                        continue
                    if names is None:
                        names = [parts(n) for n in NAME.findall(line)]
                    found = [n for n in names if " " in n and word.search(n)]
                    if not found:
                        continue
                    said = found[0]
                else:
                    said = word.search(plain)[0]
                yield name, number, f"{said!r}: {row['instead']}"


# --- spoken ---

def prose(tree):
    """The paragraphs of comments and documents: file, line, text."""
    for name, text in tree.of(CXX):
        for line, paragraph in cxx_text.paragraphs(text):
            yield name, line, paragraph
    for name, text in tree.of({".md"}):
        if NAMES_OLD_WORDS.match(name):
            continue
        number = 1
        for paragraph in text.split("\n\n"):
            yield name, number, " ".join(paragraph.split())
            number += paragraph.count("\n") + 2


def compiled_spoken(tables):
    return [(re.compile(rf"\b{r['word']}(?!\w)", re.IGNORECASE), re.compile(r.get("unless", "$.^")), r["instead"])
            for r in tables["spoken"]]


def spoken(tree, tables):
    rows = compiled_spoken(tables)
    for name, line, paragraph in prose(tree):
        plain = re.sub(r"`[^`]*`|\"[^\"]*\"", "X", paragraph)  # Code and quoted texts are no prose of ours.
        for word, unless, instead in rows:
            for match in word.finditer(unless.sub("X", plain)):
                yield name, line, f"{match[0]!r}: {instead}"


def spoken_names(tree, tables):
    rows = compiled_spoken(tables)
    for name, text in tree.of(CXX | {".py", ".js"}):
        if NAMES_OLD_WORDS.match(name):
            continue
        for number, line in enumerate(text.split("\n"), 1):
            if TEST_NAME.match(line):
                continue
            for identifier in sorted(set(NAME.findall(re.sub(r"//.*|#.*|\"[^\"]*\"", "", line)))):
                for word, _, instead in rows:
                    if word.search(parts(identifier)):
                        yield name, number, f"{identifier!r}: {instead}"


# --- types ---

def types(tree, _):
    places = collections.defaultdict(list)
    for name in tree.names:
        if name.startswith(PRODUCT) and name.endswith((".h", ".cpp")):
            for line, full in cxx_text.types_of(tree.read(name)):
                places[full].append((name, line))
    for full, at in sorted(places.items()):
        if len(at) > 1 and any(tree.wanted(name) for name, _ in at):
            others = ", ".join(f"{name}:{line}" for name, line in at[1:])
            yield at[0][0], at[0][1], f"{full} is also at {others}"


RULES = {
    "fragments": fragments,
    "inner": lambda tree, tables: fragments(tree, tables, inner=True),
    "limits": limits,
    "private": lambda tree, tables: words(tree, tables["private"]),
    "spoken": spoken,
    "spoken_names": spoken_names,
    "types": types,
}


def folder_of(name):
    folders = name.split("/")[:-1][:2]
    return "/".join(folders) or "."


def main():
    said = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    said.add_argument("root", nargs="?", default=str(HERE.parents[1]))
    said.add_argument("--rules", default=",".join(RULES))
    said.add_argument("--under", default="")
    said.add_argument("--count", action="store_true")
    said.add_argument("--show", action="store_true")
    options = said.parse_args()
    tables = tomllib.loads((HERE / "words.toml").read_text(encoding="utf-8"))
    tree = Tree(options.root, options.under)
    found = {rule: list(RULES[rule](tree, tables)) for rule in options.rules.split(",")}
    if options.show or not options.count:
        for rule, reports in found.items():
            for name, line, what in reports:
                print(f"{name}:{line}: {rule}: {what}")
    total = sum(len(reports) for reports in found.values())
    if options.count:
        counts = collections.Counter((folder_of(r[0]), rule) for rule, reports in found.items() for r in reports)
        print(" ".join(f"{rule:>10}" for rule in found) + "  folder")
        for folder in sorted({f for f, _ in counts}):
            print(" ".join(f"{counts[folder, rule] or '.':>10}" for rule in found) + f"  {folder}")
        print(" ".join(f"{len(reports):>10}" for reports in found.values()) + "  in all")
        return 0
    if not total:
        print(f"words: ok ({options.rules})")
    return 1 if total else 0


if __name__ == "__main__":
    sys.exit(main())
