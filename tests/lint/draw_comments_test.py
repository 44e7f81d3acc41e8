#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Whether draw_comments.py draws the product's comments and nothing else. Run: draw_comments_test.py"""
import pathlib
import subprocess
import sys
import tempfile

DRAW = pathlib.Path(__file__).with_name("draw_comments.py")
SOURCE = """// SPDX-License-Identifier: Apache-2.0
/// A block of two
/// lines.
namespace cyclorama {
int one = 1;  // Number {0}.
// clang-format off
int two = 2;  // NOLINT(readability)
}  // namespace cyclorama
"""


def draw(files, *options):
    with tempfile.TemporaryDirectory() as folder:
        root = pathlib.Path(folder)
        for name, text in files.items():
            (root / name).parent.mkdir(parents=True, exist_ok=True)
            (root / name).write_text(text, encoding="utf-8")
        done = subprocess.run([sys.executable, DRAW, root, *options], capture_output=True, text=True, check=False)
        return done.returncode, done.stdout, done.stderr


def drawn(out):
    """The place of each drawn comment: "file:line"."""
    return [line.split(". ", 1)[1] for line in out.splitlines() if line.split(". ", 1)[0].isdigit()]


def check_what_is_drawn():
    code, out, err = draw({"common/a.h": SOURCE, "tests/unit/a_test.cpp": SOURCE, "kiosk/a.py": "# no C++"}, "--seed=1")
    assert code == 0 and not err, err
    assert drawn(out) == ["common/a.h:2", "common/a.h:5"], out
    assert "/// lines.\nnamespace cyclorama {\nint one" in out and out.endswith("2 of 2 comments, seed 1\n"), out


def check_the_seed():
    files = {f"common/a{n}.h": f"// Number {n}.\nint a{n};\n" for n in range(40)}
    _, first, _ = draw(files, "--seed", "7", "--count", "10")
    assert len(set(drawn(first))) == 10, first
    assert draw(files, "--seed", "7", "--count", "10")[1] == first
    assert drawn(draw(files, "--seed", "8", "--count", "10")[1]) != drawn(first)


def check_the_extremes():
    assert draw({}, "--seed", "1") == (0, "0 of 0 comments, seed 1\n", "")
    one = {"common/a.h": "// One.\n", "common/b/b.h": "// Two.\n"}
    assert drawn(draw(one, "--seed", "1", "--under", "common/b")[1]) == ["common/b/b.h:1"]
    assert draw(one)[0] == 2 and "--seed" in draw(one)[2]
    code, out, err = draw(one, "--seed", "1", "--count", "0")
    assert code == 2 and not out and "at least 1" in err, err


if __name__ == "__main__":
    check_what_is_drawn()
    check_the_seed()
    check_the_extremes()
    print("draw_comments_test: ok")
