#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Tests watching a farm: metrics, page and pictures over HTTP with a token, `cyclorama-farm top` through a Unix socket,
and a file for node_exporter.

Run: watch_test.py SOURCE_ROOT BUILD_FOLDER
"""
import base64
import json
import pathlib
import re
import subprocess
import sys
import tempfile
import urllib.error
import urllib.request

from farm.farm import Farm, make_scene
from farm.processes import free_port, wait_until

TOKEN = "aladdin-opens-sesame"
MUSEUM = "Hall \"3\""
SETTINGS = """
museums = "[::1]:0"
nodes = "[::1]:0"
inspect = "unix:{folder}/inspect.sock"
[[scene]]
name = "visit"
path = "{scene}"
[watch]
address = "{address}"
metrics_file = "{folder}/farm.prom"
"""
SAMPLE = re.compile(r'([a-z_]+)(\{(?:[a-z]+="(?:[^"\\]|\\.)*",?)+\})? (\S+)')


def samples(text):
    """Returns the values by name and labels, as written."""
    lines = [line for line in text.splitlines() if line and not line.startswith("#")]
    matches = [SAMPLE.fullmatch(line) for line in lines]
    assert all(matches), [line for line, match in zip(lines, matches) if not match]
    return {match[1] + (match[2] or ""): float(match[3]) for match in matches}


class Page:
    def __init__(self, port):
        self.root = f"http://[::1]:{port}"

    def open(self, path, authorization=f"Bearer {TOKEN}"):
        headers = {"Authorization": authorization} if authorization else {}
        return urllib.request.urlopen(urllib.request.Request(self.root + path, headers=headers), timeout=30)

    def get(self, path):
        with self.open(path) as answer:
            return answer.read().decode()

    def status(self, path, authorization=None):
        try:
            with self.open(path, authorization) as answer:
                return answer.status
        except urllib.error.HTTPError as error:
            return error.code


def pictures(answer, count):
    """Reads the next parts of a multipart/x-mixed-replace stream, by RFC 2046."""
    boundary = ("--" + re.search("boundary=(.+)", answer.headers["Content-Type"])[1]).encode()
    parts = []
    while len(parts) < count:
        line = answer.readline().strip()
        assert line in (b"", boundary), line
        if line != boundary:
            continue
        headers = dict(line.decode().split(": ", 1) for line in iter(lambda: answer.readline().strip(), b""))
        assert headers["Content-Type"] == "image/jpeg", headers
        parts.append(answer.read(int(headers["Content-Length"])))
    return parts


def refuses_to_be_seen_by_all(build, folder, settings):
    """Checks access from other addresses without a token."""
    open_to_all = folder / "open.toml"
    open_to_all.write_text(settings.replace("[::1]:", "[::]:").replace('museums = "[::]', 'museums = "[::1]')
                           .replace('nodes = "[::]', 'nodes = "[::1]'))
    run = subprocess.run([build / "bin/cyclorama-farm", "--config", open_to_all], capture_output=True, text=True, timeout=60)
    assert run.returncode == 1 and "token_file" in run.stderr, (run.returncode, run.stderr)


def top(build, folder, *options):
    command = [build / "bin/cyclorama-farm", "top", "--config", folder / "farm.toml", *options]
    return subprocess.run(command, check=True, capture_output=True, text=True, timeout=60).stdout


def check_access(page):
    for path in ("/", "/status", "/sessions", "/metrics", "/sessions/1.mjpeg", "/nothing"):
        assert page.status(path) == 401, path
        assert page.status(path, "Bearer wrong-wrong-wrong-wrong") == 401, path
    basic = "Basic " + base64.b64encode(f"operator:{TOKEN}".encode()).decode()
    assert page.status("/", basic) == page.status("/metrics", basic) == page.status("/health") == 200


def check_pictures(build, folder, page, farm):
    [visit] = json.loads(page.get("/sessions"))
    stream = page.open(f"/sessions/{visit['id']}.mjpeg?half")
    first, second = pictures(stream, 2)
    for name, jpeg in (("first", first), ("second", second)):
        (folder / f"{name}.jpg").write_bytes(jpeg)
    # Both can be decoded, have one size, and differ, since the visitor walks.
    subprocess.run([build / "bin/cyclorama-render", "compare", folder / "first.jpg", folder / "second.jpg"], check=True,
                   capture_output=True, timeout=60)
    assert first != second
    farm.forget_museum(MUSEUM)
    stream.read()  # Ends with the visit.
    assert page.status(f"/sessions/{visit['id']}.mjpeg", f"Bearer {TOKEN}") == 404


def check(build, folder, page, farm):
    farm.ready()
    wait_until(lambda: page.status("/health") == 200, 20, "the coordinator's next update")
    check_access(page)
    assert '"sessions"' in page.get("/page.js")
    museum = farm.add_museum(MUSEUM, "--budget-ms", 400)
    wait_until(lambda: len(museum.whole_frames()) > 10, 60, "pictures")
    label = r'{museum="Hall \"3\""}'
    before = samples(page.get("/metrics"))
    wait_until(lambda: samples(page.get("/metrics"))[f"cyclorama_frames_total{label}"] >
               before[f"cyclorama_frames_total{label}"], 60, "more frames counted")
    wait_until(lambda: samples(page.get("/metrics")).get('cyclorama_node_memory_bytes{node="node-1"}', 0) > 1e6, 60,
               "the nodes' metrics")
    metrics = samples(page.get("/metrics"))
    assert metrics["cyclorama_nodes"] == 2 and metrics[f"cyclorama_sessions{label}"] == 1, metrics
    assert metrics[f"cyclorama_session_budget_seconds{label}"] == 0.4, metrics
    for stage in ("queue", "plan", "fan_out", "render", "encode", "relay", "overhead", "farm"):
        assert metrics[f'cyclorama_frame_seconds_count{{stage="{stage}"}}'] > 0, stage
    assert samples((folder / "farm.prom").read_text()).keys() >= {"cyclorama_nodes"}
    seen = json.loads(top(build, folder, "--json"))
    assert seen["healthy"] and seen["sessions"][0]["museum"] == MUSEUM and seen["sessions"][0]["budget_ms"] == 400, seen
    assert sorted(node["name"] for node in seen["nodes"]) == ["node-1", "node-2"], seen
    table = top(build, folder)
    assert "node-1" in table and MUSEUM in table and "\x1b" not in table, table
    check_pictures(build, folder, page, farm)
    print(json.dumps({name: seen["stages"][name] for name in ("plan", "fan_out", "relay", "overhead")}))


def main(_, build):
    build = pathlib.Path(build)
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        scene, port = make_scene(build, folder), free_port()
        settings = SETTINGS.format(folder=folder, scene=scene, address=f"[::1]:{port}")
        refuses_to_be_seen_by_all(build, folder, settings)
        (folder / "token").write_text(TOKEN + "\n")
        (folder / "farm.toml").write_text(settings + f'token_file = "{folder}/token"\n')
        with Farm(build, folder, nodes=2, scene=scene, coordinator_options=("--config", folder / "farm.toml")) as farm:
            try:
                check(build, folder, Page(port), farm)
            except AssertionError as error:
                print(farm.coordinators[0].process.output()[-2000:], error, sep="\n")
                return 1
        assert not (folder / "farm.prom").exists(), "the metrics of a stopped coordinator stay"
        if farm.stuck:
            print(f"{farm.stuck} processes had to be killed")
            return 1
    print("watch: ok")
    return 0


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
