#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Whether check_layers.py finds what it must not let pass. Run: check_layers_test.py"""
import pathlib
import subprocess
import sys
import tempfile

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
    truth = {TRUTH: "// what is\n"}
    expect(truth, 0)
    expect({**truth, "appliance/a.cpp": f'#include "{TRUTH}"\n'}, 1, "appliance/a.cpp:1")
    # By way of others, which look harmless.
    chain = {"drivers/b.h": '#include "drivers/c.h"\n', "drivers/c.h": f'#include "{TRUTH}"\n'}
    expect({**truth, **chain, "appliance/a.cpp": '#include "drivers/b.h"\n'}, 1, "drivers/b.h -> drivers/c.h -> " + TRUTH)
    expect({**truth, **chain}, 0)
    expect({**truth, **chain, "tests/a.cpp": f'#include "{TRUTH}"\n'}, 0)
    # Headers that include each other end the search all the same.
    ring = {"drivers/b.h": '#include "drivers/c.h"\n', "drivers/c.h": '#include "drivers/b.h"\n'}
    expect({**ring, "appliance/a.cpp": '#include "drivers/b.h"\n'}, 0)
    for name in ("appliance/a.cpp", "kiosk/page.js"):
        expect({name: 'open(folder + "/truth.toml")\n'}, 1, f"{name}:1")
    expect({"appliance/a.cpp": "const auto& t = museum->truth();\n"}, 1, "appliance/a.cpp:1")
    expect({"kiosk/a.cpp": '#include "appliance/a.h"\n', "appliance/a.h": ""}, 1, "may not include")
    print("check_layers: finds what it must")


if __name__ == "__main__":
    main()
