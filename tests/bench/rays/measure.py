# SPDX-License-Identifier: Apache-2.0
"""Prints the table and the JSON line of tracer-rays: measure.py BUILD_FOLDER PACKAGE SIZE FRAMES.

The three programs take turns, and a ratio is the turns' median. The tutorial is Debian's /usr/bin/pathtracer. It
traces a shadow ray to every lamp at every surface, so it gets one lamp, a point in the middle of the ceiling: half of
its rays are then shadow rays, nearly as with ours. Some of its shadow rays point away from the lamp and end at once; we
trace none of those. Its BVH is not in robust mode, which favours it by one or two percent. It prints its rays per
second of wall time, from which rays per frame follow. Its cpu-seconds are those of a run with FRAMES frames minus those
of a run with one, which excludes loading.
"""
import json
import os
import pathlib
import re
import resource
import statistics
import subprocess
import sys
import tempfile
import tomllib

build, package, size, frames = sys.argv[1], sys.argv[2], sys.argv[3], int(sys.argv[4])
TURNS = 3
BOUNCES = 2
SAMPLES = 16
FIELD_DEG = 75.0


def run(*command):
    """Returns its output and its cpu-seconds."""
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    done = subprocess.run([str(part) for part in command], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    if done.returncode != 0:
        sys.exit(f"{command[0]} failed: {done.stderr[-2000:]}")
    return done.stdout, after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime


def ours(folder):
    figures = os.path.join(folder, "ours.json")
    run(f"{build}/bin/cyclorama-render", "picture", package, "--camera", "perspective", "--field-deg", FIELD_DEG,
        "--size", size, "--samples", SAMPLES, "--bounces", BOUNCES, "--threads", 1, "--json", figures,
        "--out", os.path.join(folder, "ours.pfm"))
    values = json.loads(pathlib.Path(figures).read_text())
    return values["rays"] / values["cpu_s"] / 1e6, values["rays"]


def raw():
    return json.loads(run(f"{build}/tests/raw_embree", package, "--size", size, "--samples", SAMPLES,
                          "--bounces", BOUNCES)[0])


def tutorial(scene):
    width, height = size.split("x")
    eye = scene["start"]["eye_m"]
    command = ["/usr/bin/pathtracer", "-i", package + ".obj", "--vp", *eye, "--vi", eye[0], eye[1], eye[2] - 1.0,
               # Its field of view is vertical.
               "--fov", 46.7, "--size", width, height, "--spp", SAMPLES, "--max-path-length", BOUNCES + 1,
               "--threads", 1, "--rtcore", "threads=1", "--legacy"]
    command += ["--pointlight", 0.0, scene["lamp"][0]["position_m"][1] - 0.05, 0.0, 60, 60, 60]
    text, many = run(*command, "--benchmark", 0, frames)
    few = run(*command, "--benchmark", 0, 1)[1]

    def value(name):
        return float(re.search(rf"{name} (\S+)", text).group(1))

    rays_per_frame = value("BENCHMARK_RENDER_MRAYPS_AVG") / value("BENCHMARK_RENDER_AVG")
    return rays_per_frame * (frames - 1) / (many - few)


if not os.path.exists(package + ".obj"):
    run(sys.executable, pathlib.Path(__file__).with_name("to_obj.py"), package, package + ".obj")
with tempfile.TemporaryDirectory() as out:
    with open(os.path.join(package, "scene.toml"), "rb") as file:
        package_text = tomllib.load(file)
    turns = [(ours(out), raw(), tutorial(package_text)) for _ in range(TURNS)]


def middle(of):
    return statistics.median(of(turn) for turn in turns)


own = middle(lambda turn: turn[0][0])
print(f"{'million rays per cpu-second':<34}{'all':>8}{'camera':>8}{'shadow':>8}{'bounce':>8}")
print(f"{'ours, shading included':<34}{own:8.2f}   ({turns[0][0][1] / 1e6:.1f} million rays)")
for title, prefix in [("Embree alone, single rays", ""), ("Embree alone, packets of 16", "packets_")]:
    names = [prefix + name for name in ("mrays_per_cpu_s", "camera", "shadow", "bounce")]
    print(f"{title:<34}" + "".join(f"{middle(lambda turn, name=name: turn[1][name]):8.2f}" for name in names))
print(f"{'Embree pathtracer tutorial':<34}{middle(lambda turn: turn[2]):8.2f}")
print(json.dumps({
    "benchmark": "tracer-rays",
    "ratio_raw_embree": round(middle(lambda turn: turn[0][0] / turn[1]["mrays_per_cpu_s"]), 3),
    "ratio_raw_packets": round(middle(lambda turn: turn[0][0] / turn[1]["packets_mrays_per_cpu_s"]), 3),
    "ratio_tutorial": round(middle(lambda turn: turn[0][0] / turn[2]), 3),
    "mrays_per_cpu_s": round(own, 3)}))
