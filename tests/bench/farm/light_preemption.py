#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Measures how soon a computation of light stops when a visit needs the processors: a node pauses it by SIGSTOP, and all of
its threads must have stopped before the time ends.

Run: light_preemption.py BUILD_FOLDER SCENE JSON
It adds the figures to the JSON object in that file, if there is one.
"""
import json
import os
import pathlib
import random
import signal
import subprocess
import sys
import tempfile
import time

PAUSES = 300
BETWEEN_S = (0.002, 0.03)


def pauses(process):
    """Pauses the process often. Returns the times in milliseconds until it had stopped, ascending."""
    chance, times = random.Random(1), []
    while len(times) < PAUSES:
        time.sleep(chance.uniform(*BETWEEN_S))
        began = time.perf_counter()
        os.kill(process.pid, signal.SIGSTOP)
        _, status = os.waitpid(process.pid, os.WUNTRACED)
        if not os.WIFSTOPPED(status):
            raise SystemExit("light_preemption: the light was finished before all pauses were measured: take a larger scene")
        times.append(1e3 * (time.perf_counter() - began))
        os.kill(process.pid, signal.SIGCONT)
    return sorted(times)


def main(build, scene, result):
    with tempfile.TemporaryDirectory() as name:
        file = pathlib.Path(name) / "light.store"
        with subprocess.Popen([f"{build}/bin/cyclorama-render", "light", scene, "--out", file],
                              stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL) as process:
            while not any(pathlib.Path(name).glob(".light.store.unfinished/*/*")):
                if process.poll() is not None:
                    raise SystemExit("light_preemption: no light is computed")
                time.sleep(0.01)
            times = pauses(process)
            process.kill()
    figures = {"pause_ms_p50": times[PAUSES // 2], "pause_ms_p99": times[PAUSES * 99 // 100], "pause_ms_max": times[-1]}
    print(f"paused {PAUSES} times: all threads stand still after {figures['pause_ms_p50']:.2f} ms (median), "
          f"{figures['pause_ms_p99']:.2f} ms (99 %), at most {figures['pause_ms_max']:.2f} ms")
    path = pathlib.Path(result)
    known = json.loads(path.read_text()) if path.is_file() and path.stat().st_size else {}
    path.write_text(json.dumps(known | figures))


if __name__ == "__main__":
    main(*sys.argv[1:])
