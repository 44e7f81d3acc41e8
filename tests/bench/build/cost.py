# SPDX-License-Identifier: Apache-2.0
"""Measures what compiling costs, in processor seconds: cost.py [--quick] [--plain] [--headers N] [--edit].

Builds the target demo, then everything, in a folder of its own without ccache; prints the headers on which most of
that time is spent, then one JSON line. With --quick it builds only demo; with --plain, without precompiled headers and
with one source at a time. With --edit it measures the time after which a changed source is under test, instead.
"""
import collections
import json
import os
import pathlib
import re
import resource
import shlex
import shutil
import subprocess
import sys
import tempfile
import time

ROOT = pathlib.Path(__file__).resolve().parents[3]
FOLDER = ROOT / "build/build-cost"
INCLUDE = re.compile(r'^#include [<"]([^>"]+)[>"]', re.MULTILINE)
UNCACHED = {**os.environ, "CCACHE_DISABLE": "1"}
EDITED = "renderfarm/render/shade.cpp"  # The dearest source of the ray tracer.
ITS_TEST = "unit/renderfarm/render/kernels_test"


def processor_seconds():
    """Returns user and system time of all children that have ended."""
    usage = resource.getrusage(resource.RUSAGE_CHILDREN)
    return usage.ru_utime + usage.ru_stime


def cost_of(command, **options):
    before = processor_seconds()
    subprocess.run(command, check=True, env=UNCACHED, **options)
    return processor_seconds() - before


def build(*target):
    return cost_of(["cmake", "--build", FOLDER, *target], stdout=sys.stderr)


def objects_by_header():
    """Returns for each header the objects that read it. Precompiled headers are not among them."""
    text = subprocess.run(["ninja", "-C", FOLDER, "-t", "deps"], check=True, capture_output=True, text=True).stdout
    objects = collections.defaultdict(list)
    for record in text.split("\n\n"):
        name, *files = record.splitlines() or [""]
        for file in files:
            objects[str((FOLDER / file.strip()).resolve())].append(name.partition(":")[0])
    return objects


def named_headers():
    """Returns the headers that sources of the tree name."""
    folders = ("common", "drivers", "renderfarm", "appliance", "kiosk", "tests")
    files = (file for folder in folders for ending in ("cpp", "h") for file in (ROOT / folder).rglob(f"*.{ending}"))
    return {name for file in files for name in INCLUDE.findall(file.read_text(encoding="utf-8")) if "." in name}


def seconds_alone(name, command):
    """Returns the time in which a compiler command parses a header, beyond that of an empty source."""
    words = shlex.split(command)
    words = words[next(i for i, word in enumerate(words) if re.search(r"(^|/)(c|g|clang)\+\+[\d.-]*$", word)):]
    for option in ("-o", "-c", "-MF", "-MT"):
        if option in words:
            at = words.index(option)
            del words[at:at + 2]
    words = [word for word in words if word not in ("-MD", "-Werror")]
    with tempfile.NamedTemporaryFile("w", suffix=".cpp") as source:
        check = [*words, "-fsyntax-only", "-w", source.name]
        empty = cost_of(check, cwd=FOLDER)
        source.write(f"#include <{name}>\n")
        source.flush()
        return max(cost_of(check, cwd=FOLDER) - empty, 0.0)


def dearest_headers(most):
    """Returns (header, objects, seconds alone) of the `most` headers that most objects read, dearest first."""
    commands = {}
    for entry in json.loads((FOLDER / "compile_commands.json").read_text(encoding="utf-8")):
        # CMake before 3.26 does not name the output.
        words = shlex.split(entry["command"])
        commands[words[words.index("-o") + 1]] = entry["command"]
    candidates = []
    objects = objects_by_header()
    for name in named_headers():
        read_by = next((found for path, found in objects.items() if path.endswith("/" + name)), [])
        command = next((commands[found] for found in read_by if found in commands), None)
        if command:
            candidates.append((len(read_by), name, command))
    rows = [(name, count, seconds_alone(name, command)) for count, name, command in sorted(candidates)[-most:]]
    return sorted(rows, key=lambda row: -row[1] * row[2])


def configure(*options):
    subprocess.run(["cmake", "--preset", "release", "-DCYCLORAMA_TESTS=ON", *options, "-B", FOLDER], check=True,
                   stdout=subprocess.DEVNULL)


def measure_edit():
    """Touches a source, builds its test and runs it; in the folder of an earlier measurement, if there is one."""
    target = ITS_TEST.replace("/", ".")
    configure()
    build("--target", target)
    (ROOT / EDITED).touch()
    start = time.monotonic()
    cpu_s = build("--target", target)
    cpu_s += cost_of(["ctest", "--test-dir", FOLDER, "--tests-regex", f"^{ITS_TEST}$"], stdout=sys.stderr)
    wall_s = time.monotonic() - start
    print(f"{EDITED} is under test after {wall_s:.1f} s, {cpu_s:.1f} of them of a processor")
    print(json.dumps({"benchmark": "build-cost", "edit_s": round(wall_s, 1), "edit_cpu_s": round(cpu_s, 1)}))


def main(words):
    if "--edit" in words:
        return measure_edit()
    most = int(words[words.index("--headers") + 1]) if "--headers" in words else 40
    shutil.rmtree(FOLDER, ignore_errors=True)
    configure(*(["-DCYCLORAMA_FAST_BUILD=OFF"] if "--plain" in words else []))
    demo_s = build("--target", "demo")
    all_s = None if "--quick" in words else demo_s + build()
    print(f"{'header':<48}{'objects':>8}{'s alone':>9}{'s':>8}")
    for name, count, seconds in dearest_headers(most):
        print(f"{name:<48}{count:>8}{seconds:>9.2f}{count * seconds:>8.0f}")
    print(json.dumps({"benchmark": "build-cost", "demo_cpu_s": round(demo_s),
                      "all_cpu_s": None if all_s is None else round(all_s)}))


if __name__ == "__main__":
    os.chdir(ROOT)
    main(sys.argv[1:])
