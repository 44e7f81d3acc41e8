# SPDX-License-Identifier: Apache-2.0
"""Prints the table and the JSON line of display-decode: decode.py BUILD_FOLDER SECONDS.

The unit is megapixels per cpu-second. tjbench reports per second of wall time, which its measured use of the processor
converts to cpu time. tjbench and our decoder take short turns, and a ratio is the turns' median. With `-yuv` tjbench
decodes to planes, as we do; without it to RGB, as displays without planes must.
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
import time

build, seconds = sys.argv[1:]
TURNS = 15
BENCH = f"{build}/tests/display_bench"


def run(*command):
    """Returns its output and its share of a processor."""
    before, start = resource.getrusage(resource.RUSAGE_CHILDREN), time.monotonic()
    text = subprocess.run(command, check=True, stdout=subprocess.PIPE, text=True).stdout
    after, wall = resource.getrusage(resource.RUSAGE_CHILDREN), time.monotonic() - start
    return text, (after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime) / wall


def tjbench(file, *options):
    text, share = run("tjbench", file, "-benchtime", seconds, "-warmup", "0.2", "-nowrite", *options)
    name = "Decomp to YUV" if options else "Decompress"
    return float(re.search(rf"{name}.*?Throughput:\s+([0-9.]+)\s+Megapixels/sec", text, re.S).group(1)) / share


def ours(folder, file):
    figures = os.path.join(folder, "ours.json")
    run(BENCH, "decode", file, "--seconds", seconds, "--json", figures)
    return json.loads(pathlib.Path(figures).read_text())["megapixels_per_s"]


with tempfile.TemporaryDirectory() as out:
    run(BENCH, "tiles", out)
    result = {}
    print(f"{'megapixels per cpu-second':<26}{'ours':>8}{'tjbench -yuv':>14}{'tjbench':>9}{'ratio':>8}")
    for file in sorted(pathlib.Path(out).glob("*.jpg")):
        turns = [(ours(out, str(file)), tjbench(str(file), "-yuv"), tjbench(str(file))) for _ in range(TURNS)]
        own, planes, rgb = (statistics.median(column) for column in zip(*turns))
        result[file.stem] = round(statistics.median(turn[0] / turn[1] for turn in turns), 3)
        print(f"{file.stem:<26}{own:8.1f}{planes:14.1f}{rgb:9.1f}{result[file.stem]:8.3f}")
print(json.dumps({"benchmark": "display-decode", "ratio_tjbench": min(result.values()), "files": result}))
