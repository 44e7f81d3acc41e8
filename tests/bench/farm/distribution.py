#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Sends a generated scene from a coordinator to nodes with empty caches, with real processes over loopback.

Run: distribution.py BUILD_FOLDER SCENE_FOLDER
"""
import contextlib
import json
import pathlib
import re
import signal
import socket
import subprocess
import sys
import tempfile
import time


def free_port():
    with socket.socket(socket.AF_INET6) as probe:
        probe.bind(("::1", 0))
        return probe.getsockname()[1]


class Farm:
    """A coordinator that sends the scene, and nodes; end() ends all processes."""

    def __init__(self, programs, scene, out):
        self.programs, self.scene, self.out = programs, scene, out
        self.museums, self.nodes = f"[::1]:{free_port()}", f"[::1]:{free_port()}"
        self.processes = []
        self.coordinator = self.start("cyclorama-farm", "--scene-on-coordinator", f"grotto={scene}", "--museums", self.museums, "--nodes", self.nodes)
        self.wait_for(lambda: "files of" in self.log("cyclorama-farm"))  # The coordinator has read the scene.

    def start(self, name, *options):
        log = open(self.out / f"{name}.log", "ab")
        process = subprocess.Popen([self.programs / name, *options], stdout=log, stderr=log)
        self.processes.append(process)
        return process

    def node(self, cache):
        return self.start("cyclorama-node", "--coordinator", self.nodes, "--cache", cache)

    def log(self, name):
        return (self.out / f"{name}.log").read_text()

    @staticmethod
    def wait_for(enough, limit_s=300):
        end = time.monotonic() + limit_s
        while not enough():
            if time.monotonic() > end:
                raise TimeoutError("the benchmark waited in vain")
            time.sleep(0.002)
        return time.monotonic()

    def first_picture(self):
        subprocess.run([self.programs / "cyclorama-visit", "--farm", self.museums, "--frames", "1", "--limit-s", "300"], check=True,
                       stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        return time.monotonic()

    def end(self):
        """Ends all processes and returns the number of bytes of files that the coordinator sent."""
        for process in reversed(self.processes):
            process.send_signal(signal.SIGTERM)
            process.wait(30)
        sent = re.findall(r"(\d+) bytes of scenes' files", self.log("cyclorama-farm"))
        return int(sent[-1]) if sent else 0


def bytes_in(folder):
    total = 0
    with contextlib.suppress(FileNotFoundError):  # A part may be renamed at this moment.
        total = sum(f.stat().st_size for f in folder.iterdir())
    return total


def scene_of(cache):
    return [d for d in (cache / "scenes").glob("*") if len(d.name) == 64]


def move(programs, scene, out):
    """Returns the seconds for the files, to the museum's first picture with an empty cache, and with a full one."""
    cache = out / "cache"
    farm = Farm(programs, scene, out)
    begun = time.monotonic()
    farm.node(cache)
    first = farm.wait_for(lambda: bytes_in(cache / "files") > 0)
    whole = farm.wait_for(lambda: scene_of(cache))
    picture = farm.first_picture()
    farm.end()
    farm = Farm(programs, scene, out)
    again = time.monotonic()
    farm.node(cache)
    again = farm.first_picture() - again
    farm.end()
    return whole - first, picture - begun, again


def kill_in_the_middle(programs, scene, out, size):
    """Returns the number of bytes that the coordinator sent twice."""
    cache = out / "killed"
    farm = Farm(programs, scene, out)
    node = farm.node(cache)
    farm.wait_for(lambda: bytes_in(cache / "files") > size / 2)
    node.kill()
    node.wait()
    farm.processes.remove(node)
    farm.node(cache)
    farm.wait_for(lambda: scene_of(cache))
    return farm.end() - size


def main(build, scene):
    programs, scene = pathlib.Path(build) / "bin", pathlib.Path(scene)
    size = sum(f.stat().st_size for f in scene.rglob("*") if f.is_file())
    with tempfile.TemporaryDirectory(dir=build) as out:
        out = pathlib.Path(out)
        files_s, picture_s, again_s = move(programs, scene, out)
        resent = kill_in_the_middle(programs, scene, out, size)
    rate = size / files_s / 1e6
    print(f"{size / 1e6:.0f} MB over loopback, verified and on disk: {files_s:.2f} s, {rate:.0f} MB/s")
    print(f"from the node's start to the first picture: {picture_s:.1f} s with an empty cache, {again_s:.1f} s with a full one")
    print(f"sent twice when the node was killed half-way: {resent / 1e6:.2f} MB")
    print(json.dumps({"benchmark": "farm-distribution", "bytes": size, "mb_per_s": round(rate, 1), "first_picture_s": round(picture_s, 2),
                      "first_picture_cached_s": round(again_s, 2), "resent_bytes": resent}))


if __name__ == "__main__":
    main(*sys.argv[1:])
