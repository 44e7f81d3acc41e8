#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Tests check_layers.py on small trees that it must pass or refuse. Run: check_layers_test.py"""
import pathlib
import subprocess
import sys
import tempfile

sys.path.insert(0, str(pathlib.Path(__file__).parent))
import check_layers  # noqa: E402

LINT = pathlib.Path(__file__).with_name("check_layers.py")
TRUTH = "drivers/simulated/museum/truth.h"


def lint(files):
    with tempfile.TemporaryDirectory() as folder:
        root = pathlib.Path(folder)
        for name, text in files.items():
            (root / name).parent.mkdir(parents=True, exist_ok=True)
            (root / name).write_text(text, encoding="utf-8")
        done = subprocess.run([sys.executable, LINT, root], capture_output=True, text=True, check=False)
        return done.returncode, done.stdout


def expect(files, code, said=""):
    got, out = lint(files)
    assert got == code and said in out, f"{files}: {got}, {out}"


def main():
    truth = {TRUTH: "// the truth\n"}
    expect(truth, 0)
    expect({**truth, "appliance/scan/a.cpp": f'#include "{TRUTH}"\n'}, 1, "appliance/scan/a.cpp:1")
    # By way of others, which look harmless.
    chain = {"drivers/simulated/b.h": '#include "drivers/simulated/c.h"\n', "drivers/simulated/c.h": f'#include "{TRUTH}"\n'}
    expect({**truth, **chain, "appliance/scan/a.cpp": '#include "drivers/simulated/b.h"\n'}, 1,
           "drivers/simulated/b.h -> drivers/simulated/c.h -> " + TRUTH)
    expect({**truth, **chain}, 0)
    expect({**truth, **chain, "tests/unit/a.cpp": f'#include "{TRUTH}"\n'}, 0)
    # Headers that include each other end the search all the same.
    ring = {"drivers/simulated/b.h": '#include "drivers/simulated/c.h"\n', "drivers/simulated/c.h": '#include "drivers/simulated/b.h"\n'}
    expect({**ring, "appliance/scan/a.cpp": '#include "drivers/simulated/b.h"\n'}, 0)
    for name in ("appliance/scan/a.cpp", "kiosk/operator/page.js"):
        expect({name: 'open(folder + "/truth.toml")\n'}, 1, f"{name}:1")
    expect({"appliance/scan/a.cpp": "const auto& t = museum->truth();\n"}, 1, "appliance/scan/a.cpp:1")

    # Rows: between top folders, within one, and for tests.
    expect({"kiosk/tour/a.cpp": '#include "appliance/warp/a.h"\n'}, 1, "kiosk/tour/ may not include appliance/warp/a.h")
    expect({"appliance/warp/a.cpp": '#include "appliance/display/a.h"\n'}, 1, "appliance/warp/ may not include")
    expect({"appliance/display/a.cpp": '#include "appliance/warp/a.h"\n'}, 0)
    expect({"appliance/display/deep/a.cpp": '#include "appliance/display/b.h"\n'}, 0)
    expect({"tests/unit/a.cpp": '#include "kiosk/tour/a.h"\n#include "tests/doubles/a.h"\n'}, 0)
    expect({"tests/doubles/a.h": '#include "tests/unit/a.h"\n'}, 1, "tests/doubles/ may not include tests/unit/a.h")
    expect({"common/base/a.h": '#include "tests/doubles/a.h"\n'}, 1, "may not include tests/doubles/a.h")
    # Every file lies in a folder that has a row.
    expect({"appliance/a.cpp": ""}, 1, "appliance/a.cpp: appliance/ has no row")
    expect({"appliance/attic/a.cpp": ""}, 1, "appliance/attic/ has no row")
    # Circles, of two folders and of three; a circle within one folder is none.
    two = {"common/image/a.h": '#include "common/base/b.h"\n', "common/base/b.h": '#include "common/image/a.h"\n'}
    expect(two, 1, "a circle in the includes: common/base -> common/image -> common/base")
    three = {"common/room/a.h": '#include "common/geometry/a.h"\n', "common/geometry/a.h": '#include "common/base/a.h"\n',
             "common/base/a.h": '#include "common/room/a.h"\n'}
    expect(three, 1, "common/base -> common/room -> common/geometry -> common/base")
    expect({"common/base/a.h": '#include "common/base/b.h"\n', "common/base/b.h": '#include "common/base/a.h"\n'}, 0)
    assert check_layers.circle({"a": {"b"}, "b": {"c"}, "c": {"b"}}) == ["b", "c", "b"]
    assert not check_layers.circle({"a": {"b", "c"}, "b": {"c"}, "c": set()})
    assert check_layers.read_rows("a/b: c/d\n    e/f\ng/h:\n") == {"a/b": {"c/d", "e/f"}, "g/h": set()}
    print("check_layers: finds what it must")


if __name__ == "__main__":
    main()
