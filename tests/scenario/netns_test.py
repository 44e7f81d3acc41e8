#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Tests coordinator, nodes and museum on hosts of their own, each of which in turn loses its network and gets it back.

No port but the coordinator's two may be open on any host.

Run: netns_test.py SOURCE_ROOT BUILD_FOLDER. It is skipped where network namespaces are impossible, or fails there
with CYCLORAMA_REQUIRE_NETNS=1.
"""
import json
import os
import pathlib
import sys
import tempfile
import time

from farm.farm import POSES, SIZE, make_scene
from farm.faults import seconds_to_full_rate
from farm.hosts import Hosts, why_not
from farm.museum import Museum, now
from farm.processes import Process, wait_until

MUSEUMS, NODES = 7401, 7402
RATE_HZ = 5  # One node of one thread can render as many.
CUT_S = 3.0
LONG_CUT_S = 12.0  # Both ends notice: they send a keepalive every 5 s and wait 5 s for the answer.
RENDERERS = ["node-1", "node-2"]


class Site:
    def __init__(self, build, folder, hosts):
        self.hosts, build = hosts, pathlib.Path(build)
        scene = make_scene(build, folder)
        at = hosts.address("coordinator")
        self.parts = {"coordinator": Process("coordinator", [*hosts.on("coordinator"), build / "bin/cyclorama-farm", "--scene", f"visit={scene}",
                                               "--museums", f"[::]:{MUSEUMS}", "--nodes", f"[::]:{NODES}",
                                               "--insecure"], folder)}
        for name in RENDERERS:
            self.parts[name] = Process(name, [*hosts.on(name), build / "bin/cyclorama-node", "--coordinator", f"[{at}]:{NODES}",
                                              "--threads", 1, "--name", name], folder)
        self.wait_for_word("has scene 'visit'", len(RENDERERS))
        self.museum = Museum("museum", build / "tests/test-museum", folder, [f"[{at}]:{MUSEUMS}"], RATE_HZ,
                             [*SIZE, "--poses", POSES], host=hosts.on("museum"))
        wait_until(self.museum.whole_frames, 60, "the first picture")

    def wait_for_word(self, word, times):
        wait_until(lambda: self.parts["coordinator"].output().count(word) >= times, 60,
                   f"{word!r} in the coordinator's log {times} times")

    def end(self):
        ended = [self.museum.end()] + [part.end() for part in self.parts.values()]
        assert all(ended), "not all processes stop on request"


def cut_a_node(site):
    """Cuts off nodes: the other keeps rendering, and the node returns by itself. Yields an action and two times in
    seconds."""
    for name, seconds in (("node-1", CUT_S), ("node-2", LONG_CUT_S)):
        began = now()
        site.hosts.unplug(name)
        without = seconds_to_full_rate(site.museum, began)
        time.sleep(max(0.0, began + seconds - now()))
        site.hosts.plug_in(name)
        back = now()
        wait_until(lambda: any(f["nodes"] == len(RENDERERS) for f in site.museum.whole_frames(back)), 30,
                   f"{name} takes part again")
        assert not site.museum.events("lost", began), "a session ended because a node was cut off"
        yield f"{name} cut off for {seconds:.0f} s", without, now() - back


def cut_everybody_from_the_coordinator(site):
    """Cuts off coordinator, then museum: no picture can arrive; afterwards pictures arrive by themselves."""
    site.hosts.unplug("coordinator")
    time.sleep(CUT_S)
    site.hosts.plug_in("coordinator")
    back = now()
    wait_until(lambda: site.museum.whole_frames(back), 30, "pictures after the coordinator was back")
    yield "coordinator cut off", CUT_S, site.museum.whole_frames(back)[0]["at_s"] - back


def cut_the_museum(site):
    site.hosts.unplug("museum")
    time.sleep(CUT_S)
    site.hosts.plug_in("museum")
    back = now()
    wait_until(lambda: site.museum.whole_frames(back), 30, "pictures after the museum was back")
    yield "museum cut off", CUT_S, site.museum.whole_frames(back)[0]["at_s"] - back


def check(site):
    listening = {name: site.hosts.listeners(name) for name in site.hosts.names}
    assert listening.pop("coordinator") == [MUSEUMS, NODES], "the coordinator listens on other ports than its two"
    assert not any(listening.values()), f"open ports that should be closed: {listening}"
    for cut in (cut_a_node, cut_everybody_from_the_coordinator, cut_the_museum):
        for what, without, back in cut(site):
            print(f"{what}: {without:.1f} s without pictures in time, back after {back:.1f} s")
    holes, breaches = site.museum.wrong()
    assert not holes and not breaches, f"{holes} frames with holes, {breaches}"
    print(json.dumps({"frames": len(site.museum.whole_frames()), "holes": holes}))


def main(_, build):
    if reason := why_not():
        print(f"netns: skipped: {reason}")
        return 1 if os.environ.get("CYCLORAMA_REQUIRE_NETNS") == "1" else 77
    with tempfile.TemporaryDirectory() as folder, Hosts(["coordinator", *RENDERERS, "museum"]) as hosts:
        site = Site(build, folder, hosts)
        try:
            check(site)
        except AssertionError as error:
            for log in sorted(pathlib.Path(folder).glob("*.log")):
                print(f"{log.name}:\n{log.read_text(errors='replace')[-600:]}")
            print(error)
            return 1
        finally:
            site.end()
    print("netns: ok")
    return 0


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
