#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Whether check_words.py finds what it must not let pass, and nothing else. Run: check_words_test.py"""
import pathlib
import subprocess
import sys
import tempfile

LINT = pathlib.Path(__file__).with_name("check_words.py")


def lint(rule, files, *options):
    with tempfile.TemporaryDirectory() as folder:
        root = pathlib.Path(folder)
        for name, text in files.items():
            (root / name).parent.mkdir(parents=True, exist_ok=True)
            (root / name).write_text(text, encoding="utf-8")
        done = subprocess.run([sys.executable, LINT, root, "--rules", rule, *options], capture_output=True, text=True,
                              check=False)
        return done.returncode, done.stdout, done.stderr


def expect(rule, text, reported, name="common/a/a.h"):
    files = text if isinstance(text, dict) else {name: text}
    code, out, err = lint(rule, files)
    assert not err, err
    found = [line for line in out.splitlines() if f": {rule}: " in line]
    assert len(found) == len(reported) and code == (1 if reported else 0), f"{text}: {out}"
    for line, wanted in zip(found, reported):
        assert line.startswith(wanted), f"{text}: {line}, not {wanted}"


FRAGMENTS = [
    "Of a lean that is not seen, from picture to picture",
    "Of the mean.",
    "What it stopped.",
    "What the wall shows before the first frame and when the farm fails: a dim sky.",
    "Whether this one is the last.",
    "That were given a block.",
    "As Config::read().",
    "By which the hours count; this computer's where there are none.",
    "Where Camera writes: arrays of as many elements as there are rays.",
    "Who may come in, what they may do there, and the record of it.",
    "How far it would move.",
]
SENTENCES = [
    "Of these numbers the first is used.",
    "By default it has one thread.",
    "What is absent is found from the geometry.",
    "That costs nothing.",
    "Where the normals disagree, light must not come through.",
    "While it lives, the call is watched.",
    "Why now?",
    "Minimum expected saving, in seconds.",
    "Returns what was asked for.",
]


def check_fragments():
    for text in FRAGMENTS:
        expect("fragments", f"/// {text}\nint a;\n", ["common/a/a.h:1:"])
        expect("inner", f"/// Thread-safe. {text}\nint a;\n", ["common/a/a.h:1:"])
        expect("fragments", f"int a;  ///< {text}\n", ["common/a/a.h:1:"])
    for text in SENTENCES:
        expect("fragments", f"// {text}\nint a;\n", [])
    # Paragraphs, and lines that are no prose.
    expect("fragments", "// One.\n//\n// Of two.\n//\n//     What an example\n", ["common/a/a.h:3:"])
    # A sentence that goes on in the next line; what follows code is a comment of its own.
    expect("fragments", "// Where it ends,\n// nothing is shown.\nint a;  // Of one.\n", ["common/a/a.h:3:"])
    expect("fragments", 'const char* a = "// Of one.";\n', [])


def check_names():
    expect("limits", "constexpr int kMostTurns = 1;\nconstexpr int kMax = 2;\nint send_patience;\n",
           ["common/a/a.h:1:", "common/a/a.h:3:"])
    expect("limits", "constexpr int kAlmost = 1;  // at most, with patience\n", [])
    expect("private", "class PlateTurn;\nclass TurnPlate;\nint turnplate_deg;  // a turn-plate\n",
           ["common/a/a.h:2:", "common/a/a.h:3:"])
    expect("private", "int most_turns;  // at most 3, the longest\n", ["common/a/a.h:1:"])
    expect("private", "line.head(2)\n", [], "renderfarm/node/a.md")
    expect("private", "the head\n", ["renderfarm/node/a.md:1:"], "renderfarm/node/a.md")
    expect("private", "the head\n", [], "appliance/a.md")
    expect("private", "the head\n", [], "renderfarm/render/a.md")
    # A line that tells of a former name, and a test's name, which is a sentence.
    expect("private", 'refuse("\'most_turns\' is now called \'max_turns\'");\nint most_turns;\n', ["common/a/a.h:2:"])
    expect("private", "TEST(Turns, most_turns_are_short) {\nint most_turns;\n", ["common/a/a.h:2:"])
    expect("private", "", ["appliance/desk/a.h:0:"], "appliance/desk/a.h")
    expect("spoken", "// It dials the farm,\n// as the message says.\nint told;\n", ["common/a/a.h:1:"])
    expect("spoken", "// `told` cannot be told from \"said\".\n", [])
    expect("spoken", "A purpose.\n\nOne line,\nand it wants more.\n", ["docs/a.md:3:"], "docs/a.md")
    expect("spoken_names", "int told_px;  // It says so.\nint toldest;\nTEST(A, asks_twice) {}\n", ["common/a/a.h:1:"])


FRAME = """namespace cyclorama {
struct Frame {
  struct Part {};
};
}  // namespace cyclorama
"""
UNNAMED = "namespace cyclorama {\nnamespace {\nstruct Frame {};\n}\n}\n"
OTHER = """namespace cyclorama {
struct Frame;
class Frame* f(struct Frame g) { struct Part {}; return 0; }
enum class Kind : int { kA };
}
"""
TEMPLATE = """namespace cyclorama {
template <typename T, class U>
class [[nodiscard]] Box final : public Base<T> {
 public:
  class Lid {};
};
}
"""
SPECIAL = "namespace cyclorama {\ntemplate <>\nstruct Box<int> {};\n}\n"


def check_types():
    expect("types", {"common/a.h": FRAME, "drivers/b.h": FRAME},
           ["common/a.h:2: types: cyclorama::Frame is also at drivers/b.h:2", "common/a.h:3:"])
    expect("types", {"common/a.h": FRAME, "drivers/b.h": FRAME.replace("cyclorama", "cyclorama::camera")}, [])
    expect("types", {"common/a.cpp": FRAME, "tests/doubles/b.cpp": FRAME.replace("Frame", "Film")}, [])
    expect("types", {"common/a.h": FRAME, "common/b.cpp": UNNAMED}, [])
    expect("types", {"common/a.h": FRAME, "common/b.h": OTHER}, [])
    expect("types", {"common/a.h": OTHER, "common/b.cpp": OTHER}, ["common/a.h:4:"])
    expect("types", {"common/a.h": TEMPLATE, "common/b.h": TEMPLATE}, ["common/a.h:3:", "common/a.h:5:"])
    expect("types", {"common/a.h": SPECIAL, "common/b.h": SPECIAL}, [])


def check_options():
    files = {"common/a/a.h": "// Of one.\n", "common/b/b.h": "// Of two.\n// Of three.\n\nint a;  // Of three.\n"}
    code, out, _ = lint("fragments", files, "--count")
    assert code == 0 and "b.h" not in out, out
    assert all(line in out for line in ("1  common/a\n", "2  common/b\n", "3  in all\n")), out
    _, out, _ = lint("fragments", files, "--count", "--show", "--under", "common/a/")
    assert "common/a/a.h:1: fragments: Of one." in out and "common/b" not in out, out


def main():
    check_fragments()
    check_names()
    check_types()
    check_options()
    print("check_words: finds what it must")


if __name__ == "__main__":
    main()
