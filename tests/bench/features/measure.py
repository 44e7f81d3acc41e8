# SPDX-License-Identifier: Apache-2.0
"""Prints the tables and the JSON line of tracer-features.

Run: measure.py BUILD_FOLDER SIZE REPETITIONS INTERIOR GROTTO [--quick]

A scene is measured with its own kernel and with those for higher surface levels; the two generated ones also under a
sky alone. Without --quick the real scenes follow where their data are there. Time is that of `cyclorama-bench-render features`. The processor counts instructions where it can; elsewhere valgrind does, on
a small picture: exact, but it emulates a processor with AVX2 at most. There the kernels differ by their shading stage
alone; the rest is shared out evenly.
"""
import json
import os
import pathlib
import re
import statistics
import subprocess
import sys
import tempfile

build, size, repetitions = sys.argv[1], sys.argv[2], int(sys.argv[3])
scenes = dict(zip(("interior", "grotto"), sys.argv[4:6]))
RENDER = f"{build}/tests/cyclorama-bench-render"
REAL = ("scenes/grotto_thousand_buddhas.glb", "scenes/hotel_room.glb", "relics/buddha_head_100k.glb", "relics/Hermes.glb")
COUNTED_SIZE = "48x18"
STAGE = re.compile(r"_ZN9cyclorama6render5shadeILNS0_12SurfaceLevelE([0-2])EE")  # The symbol of a shading stage.


def run(*command):
    done = subprocess.run([str(part) for part in command], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
    if done.returncode != 0:
        sys.exit(f"{command[0]} failed: {done.stderr[-2000:]}")
    return done.stdout


def under_sky(package):
    """Returns a copy of the package with a sky instead of its lamps."""
    package = pathlib.Path(package)
    other = pathlib.Path("build/features") / f"{package.parent.name}-{package.name}-sky"
    other.mkdir(parents=True, exist_ok=True)
    for file in package.iterdir():
        if file.suffix == ".toml" or (other / file.name).exists():
            continue
        (other / file.name).hardlink_to(file)
    text = re.sub(r"(?ms)^\[\[lamp\]\]\n.*?(?=^\[|\Z)", "", (package / "scene.toml").read_text())
    sky = "[sky]\nzenith = [1, 1, 1]\nhorizon = [1, 1, 1]\nground = [1, 1, 1]\n\n"
    (other / "scene.toml").write_text(text.replace("[[geometry]]", sky + "[[geometry]]", 1))
    return other


def features(scene, picture, times, prefix=()):
    with tempfile.TemporaryDirectory() as folder:
        figures = pathlib.Path(folder) / "figures.json"
        run(*prefix, RENDER, "features", scene, "--size", picture, "--repetitions", times, "--json", figures)
        (report,) = json.loads(figures.read_text()).values()
        return report


def emulated(scene, times):
    """Returns the instructions of all cells, and of each surface level's shading stage with its callees."""
    with tempfile.TemporaryDirectory() as folder:
        out = pathlib.Path(folder) / "callgrind.out"
        report = features(scene, COUNTED_SIZE, times,
                          ("valgrind", "--tool=callgrind", "--demangle=no", f"--callgrind-out-file={out}"))
        text = run("callgrind_annotate", "--inclusive=yes", "--threshold=100", "--auto=no", out)
    cells, kernels = 0, {}
    for count, name in re.findall(r"^\s*([\d,]+) (?:\([^)]*\)\s+)?\S*?:(_ZN9cyclorama\S*)", text, re.M):
        count = int(count.replace(",", ""))
        if name.startswith("_ZN9cyclorama6render10trace_cell"):
            cells = max(cells, count)
        elif stage := STAGE.match(name):
            level = int(stage[1])
            kernels[level] = max(kernels.get(level, 0), count)
    return report, cells, kernels


def count_by_valgrind(scene, report):
    """Sets the instructions to those that a second repetition adds, which excludes work that happens once."""
    _, cells_once, once = emulated(scene, 1)
    counted, cells_twice, twice = emulated(scene, 2)
    of_kernel = {kernel: twice[kernel] - once[kernel] for kernel in twice}
    rows = [report["kernel"]] + [f["kernel"] for f in report["features"].values()]
    rest = (cells_twice - cells_once - sum(of_kernel.values())) / len(rows)
    per_ray = [(of_kernel[kernel] + rest) / counted["rays"] for kernel in rows]
    report["instructions_per_ray"] = per_ray[0]
    for feature, count in zip(report["features"].values(), per_ray[1:]):
        feature["instructions_per_ray"] = count
        feature["instruction_saving"] = 1 - per_ray[0] / count


def has_valgrind():
    return subprocess.run(["sh", "-c", "command -v valgrind"], stdout=subprocess.DEVNULL).returncode == 0


def percent(value):
    return "-" if value is None else f"{100 * value:.1f}"


generated = list(scenes)
if "--quick" not in sys.argv[6:]:
    data = pathlib.Path(os.environ.get("CYCLORAMA_SHARED", "../shared")) / "data"
    scenes |= {pathlib.Path(name).stem: data / name for name in REAL if (data / name).is_file()}
for name in generated:
    scenes[f"{name}, sky"] = under_sky(scenes[name])
counted_by = "the processor"
savings = {}
for name, scene in scenes.items():
    report = features(scene, size, repetitions)
    if report["instructions_per_ray"] is None:
        counted_by = "valgrind" if has_valgrind() else "nobody"
        if has_valgrind():
            count_by_valgrind(scene, report)
    instructions = report["instructions_per_ray"]
    print(f"\n{name}: {report['ns_per_ray']:.0f} ns per ray" +
          ("" if instructions is None else f", {instructions:.0f} instructions per ray"))
    print(f"  {'instead of':<22}{'saves % of time':>16}{'% of instructions':>19}")
    for feature, saved in report["features"].items():
        print(f"  {feature:<22}{percent(saved['time_saving']):>16}{percent(saved['instruction_saving']):>19}")
        savings.setdefault(feature, []).append(saved)
print(f"\nmedians of the scenes; instructions counted by {counted_by}")
medians, counted = {}, {}
for feature, found in savings.items():
    medians[feature] = round(statistics.median(saved["time_saving"] for saved in found), 4)
    instructions = [saved["instruction_saving"] for saved in found if saved["instruction_saving"] is not None]
    counted[feature] = round(statistics.median(instructions), 4) if instructions else None
    print(f"  {feature:<22}{percent(medians[feature]):>16}{percent(counted[feature]):>19}")
print(json.dumps({"benchmark": "tracer-features", **medians, "instructions": counted, "counted_by": counted_by}))
