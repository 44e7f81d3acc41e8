#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Measures a visit of a scene with stored light: a coordinator, a node and a museum with TLS, all on the same cores.

A governed visit gives frames a second and their error against path tracing; frames of fixed quality, as
fast as they come, on one core and on two, give the cores for 20 frames a second; a rest shows the step from the last
moving picture to the first at rest.

Run: light_visit.py BUILD_FOLDER SCENE WIDTHxHEIGHT BUDGET_MS SECONDS SAMPLES JSON
"""
import collections
import json
import os
import pathlib
import subprocess
import sys
import tempfile
import time

sys.path.append(str(pathlib.Path(__file__).resolve().parents[2] / "scenario"))
from farm.authority import TLS, Authority  # noqa: E402
from farm.museum import Museum, now  # noqa: E402
from farm.processes import Process, free_port, wait_until  # noqa: E402

POSES = 2400  # A walk of 45 degrees in ten seconds.
RATE_HZ = 30
GOAL_FPS = 20
FRAMES_JUDGED = 3
MIN_FRAMES = 6


class Visit:
    """A context manager: a farm of one node, and museums one after the other, bound to the given cores."""

    def __init__(self, build, folder, scene, size, cores):
        self.build, self.folder, self.cores, self.running = pathlib.Path(build), pathlib.Path(folder), cores, []
        self.size = size
        self.museums, nodes, self.inspect = free_port(), free_port(), f"unix:{folder}/inspect.sock"
        authority = Authority(build, folder)
        for role, name, *more in (("coordinator", "farm", "--address", "::1"), ("node", "n1"), ("museum", "hall")):
            authority.bundle(role, name, *more)
        (self.folder / "museums.toml").write_text('[[museum]]\nname = "hall"\nscenes = ["*"]\n')
        (self.folder / "farm.toml").write_text(
            f'museums = "[::]:{self.museums}"\nnodes = "[::]:{nodes}"\ninspect = "{self.inspect}"\nmuseums_file = "museums.toml"\n'
            f'[[scene]]\nname = "visit"\npath = "{scene.resolve()}"\n[tls]\n' + TLS.format("farm"))
        (self.folder / "node.toml").write_text(
            f'coordinator = "[::1]:{nodes}"\nthreads = {len(cores)}\n[tls]\n' + TLS.format("n1"))
        self.coordinator = self.start("farm")
        self.node = self.start("node")
        wait_until(lambda: "has its light computed" in self.coordinator.output(), 300, "the scene and its light", 0.2)

    def __enter__(self):
        return self

    def __exit__(self, *_):
        for process in reversed(self.running):
            process.end()

    def start(self, name):
        log = f"{name}-{len(self.cores)}"
        self.running.append(Process(log, ["taskset", "-c", ",".join(map(str, self.cores)), self.build / "bin" /
                                          f"cyclorama-{name}", "--config", self.folder / f"{name}.toml"], self.folder))
        return self.running[-1]

    def cpu_seconds(self):
        return {"node": self.node.cpu_seconds(), "coordinator": self.coordinator.cpu_seconds()}

    def museum(self, name, *options):
        return Museum(name, self.build / "tests" / "test-museum", self.folder, [f"[::1]:{self.museums}"], RATE_HZ,
                      ["--bundle", self.folder / "hall", "--width", self.size[0], "--height", self.size[1], "--poses", POSES,
                       *options], host=("taskset", "-c", ",".join(map(str, self.cores))))

    def walk(self, name, seconds, settling, *options):
        """Returns the frames of a walk after `settling` seconds, their rate, and cpu-seconds a frame by process."""
        museum = self.museum(name, *options)
        wait_until(lambda: len(museum.whole_frames()) > 1, 120, "frames", 0.1)
        time.sleep(settling)
        began, before = now(), self.cpu_seconds()
        time.sleep(seconds)
        wait_until(lambda: len(museum.whole_frames(began)) >= MIN_FRAMES, 120, "enough frames", 0.1)
        ended, after = now(), self.cpu_seconds()
        frames = museum.whole_frames(began, ended)
        assert museum.end() and museum.wrong() == (0, []), museum.wrong()
        per_frame = {process: (after[process] - before[process]) / len(frames) for process in before}
        return frames, (len(frames) - 1) / (frames[-1]["at_s"] - frames[0]["at_s"]), per_frame

    def stages(self):
        command = [self.build / "bin" / "cyclorama-farm", "top", "--inspect", self.inspect, "--json"]
        return json.loads(subprocess.run(command, check=True, capture_output=True).stdout)["stages"]


def quality(frame, size):
    kind = "stored light" if frame["stored_light"] else "denoised paths" if frame["denoise"] else "paths"
    return f"{kind}, {frame['samples']} samples, {frame['width_px'] / size[0]:.0%} of the size"


def judged(build, folder, scene, size, frames):
    """Returns relMSE and FLIP of some of the frames."""
    views, result = folder / "views", folder / "errors.json"
    chosen = frames[::max(1, len(frames) // FRAMES_JUDGED)][:FRAMES_JUDGED]
    views.write_text("".join(frame["view_hex"] + "\n" for frame in chosen))
    subprocess.run([f"{build}/tests/cyclorama-bench-render", "visit", scene, "--views", views, "--width", str(size[0]), "--height",
                    str(size[1]), "--json", result], check=True, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    return json.loads(result.read_text())


def rest_step(visit, seconds):
    """Returns FLIP between the last moving picture and the first at rest, and what the moving one was."""
    museum = visit.museum("rest", "--budget-ms", 1000, "--pictures", visit.folder, "--walk-s", seconds, "--rest-s", 1000)
    wait_until(lambda: (visit.folder / "rest.png").exists(), 180, "a picture at rest", 0.1)
    last = museum.whole_frames()[-1]
    museum.end()
    result = visit.folder / "step.json"
    subprocess.run([visit.build / "bin" / "cyclorama-render", "compare", visit.folder / "rest.png", visit.folder / "walking.png",
                    "--json", result], check=True, capture_output=True)
    return json.loads(result.read_text())["flip"], quality(last, visit.size)


def cores_table(measured):
    """Prints frames a second on more cores, simulated from the cpu-seconds a frame on two: all cores share the work, but
    the coordinator's is done by one. Returns the cores for GOAL_FPS."""
    node, serial = measured[2]["cpu_s"]["node"], measured[2]["cpu_s"]["coordinator"]
    efficiency = measured[2]["fps"] * (node + serial) / 2.0
    print(f"  {'cores':>6}{'frames/s':>10}")
    for count in sorted(measured):
        print(f"  {count:>6}{measured[count]['fps']:>10.2f}  measured")
    needed = None
    for count in (4, 8, 16, 32, 64, 128, 256):
        fps = efficiency / max((node + serial) / count, serial)
        print(f"  {count:>6}{fps:>10.2f}  from {node:.3f} + {serial:.4f} cpu-s a frame, {efficiency:.0%} of the time used")
        needed = needed or (count if fps >= GOAL_FPS else None)
    return needed


def main(build, scene, size, budget_ms, seconds, samples, result):
    scene, seconds, size = pathlib.Path(scene), float(seconds), tuple(map(int, size.split("x")))
    subprocess.run([f"{build}/bin/cyclorama-render", "light", scene, "--if-needed"], check=True)
    cores = sorted(os.sched_getaffinity(0))[:2]
    measured, figures = {}, {}
    with tempfile.TemporaryDirectory() as name:
        for count in range(1, len(cores) + 1):
            folder = pathlib.Path(name) / str(count)
            folder.mkdir()
            with Visit(build, folder, scene, size, cores[-count:]) as visit:
                frames, fps, cpu_s = visit.walk("fixed", seconds, 2.0, "--samples", samples, "--stored-light", "--blind")
                measured[count] = {"fps": fps, "cpu_s": cpu_s}
                if count < len(cores):
                    continue
                fixed = judged(build, folder, scene, size, frames)
                print(f"{quality(frames[-1], size)}, as fast as they come: {fps:.2f} frames/s, relMSE {fixed['relmse']:.5f}, "
                      f"FLIP {fixed['flip']:.4f}; cpu-s a frame: " + ", ".join(f"{k} {v:.4f}" for k, v in cpu_s.items()))
                frames, fps, cpu_s = visit.walk("governed", seconds, 12.0, "--budget-ms", budget_ms, "--blind")
                errors = judged(build, folder, scene, size, frames)
                print(f"governed, {budget_ms} ms a frame: {fps:.2f} frames/s, relMSE {errors['relmse']:.5f}, FLIP {errors['flip']:.4f}")
                qualities = collections.Counter(quality(frame, size) for frame in frames)
                for what, times in sorted(qualities.items(), key=lambda item: -item[1])[:4]:
                    print(f"  {times} of {len(frames)} frames: {what}")
                for stage in ("queue", "plan", "fan_out", "render", "encode", "relay", "overhead", "farm"):
                    row = visit.stages()[stage]
                    print(f"  {stage:<10}p50 {row['p50_ms']:>8.2f} ms  p95 {row['p95_ms']:>8.2f} ms")
                mpx = 1e-6 * size[0] * size[1] * (frames[-1]["width_px"] / size[0]) ** 2
                figures = {"fps": fps, **errors, "mpx": mpx, "samples": frames[-1]["samples"], "fixed_fps": measured[count]["fps"],
                           "fixed_relmse": fixed["relmse"], "fixed_flip": fixed["flip"]}
                step, what = rest_step(visit, 15)
                print(f"from the last moving picture ({what}) to the first at rest: FLIP {step:.4f}")
                figures["rest_step_flip"] = step
    if 2 in measured:
        figures["cores_for_20_fps"] = cores_table(measured)
    pathlib.Path(result).write_text(json.dumps({**figures, "fps_by_cores": {n: m["fps"] for n, m in measured.items()}}))


if __name__ == "__main__":
    main(*sys.argv[1:])
