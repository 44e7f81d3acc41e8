# SPDX-License-Identifier: Apache-2.0
"""The farm under test: coordinators, nodes of one thread and museums; a link that can be cut precedes each node and
museum."""
import itertools
import pathlib
import subprocess

from farm.link import Link, Network
from farm.museum import Museum
from farm.processes import Process, free_port, wait_until

# Two museums of this size keep two cores half busy: a farm without spare capacity has no full rate to return to.
SIZE = ("--width", 320, "--height", 160)
POSES = 120
RATE_HZ = 10


def make_scene(build, folder, triangles=10000):
    scene = pathlib.Path(folder) / f"grotto-{triangles}"
    subprocess.run([f"{build}/bin/cyclorama-grotto", "--triangles", str(triangles), "--out", scene], check=True,
                   capture_output=True)
    return scene


class Coordinator:
    def __init__(self, farm, name):
        self.farm, self.name = farm, name
        self.museums, self.nodes = free_port(), free_port()
        self.start()

    def start(self):
        self.process = Process(self.name, [self.farm.program("farm"), "--scene", f"visit={self.farm.scene}", "--museums",
                                           f"[::1]:{self.museums}", "--nodes", f"[::1]:{self.nodes}",
                                           *self.farm.coordinator_options], self.farm.folder)


class Node:
    """A node that connects to every coordinator, each through a link of its own."""

    def __init__(self, farm, name):
        self.farm, self.name = farm, name
        self.links = [Link(farm.network, coordinator.nodes) for coordinator in farm.coordinators]
        self.start()

    def start(self):
        self.heard = [len(coordinator.process.output()) for coordinator in self.farm.coordinators]
        coordinators = [argument for link in self.links for argument in ("--coordinator", link.address)]
        self.process = Process(self.name, [self.farm.program("node"), "--threads", 1, "--name", self.name, *coordinators,
                                           *self.farm.node_options], self.farm.folder)

    def is_ready(self):
        """Returns whether a coordinator has logged since the node's start that it has the scene."""
        return any(f"{self.name}' has scene" in coordinator.process.output()[heard:]
                   for coordinator, heard in zip(self.farm.coordinators, self.heard))


class Farm:
    """A context manager that leaves no process behind and counts in `stuck` those that did not stop on request."""

    def __init__(self, build, folder, coordinators=1, nodes=4, scene=None, coordinator_options=(), node_options=()):
        self.build, self.folder = pathlib.Path(build), pathlib.Path(folder)
        self.coordinator_options, self.node_options = coordinator_options, node_options
        self.scene = scene or make_scene(build, folder)
        self.stuck, self.numbers, self.museums, self.past, self.nodes = 0, itertools.count(1), {}, [], []
        self.counts, self.network, self.coordinators = (coordinators, nodes), Network(), []

    def __enter__(self):
        try:
            self.coordinators += [Coordinator(self, f"coordinator-{i}") for i in range(1, self.counts[0] + 1)]
            for _ in range(self.counts[1]):
                self.add_node()
        except Exception:
            self.__exit__()
            raise
        return self

    def __exit__(self, *_):
        for museum in self.museums.values():
            self.stuck += not museum.end()
        for part in self.nodes + self.coordinators:
            self.stuck += part.process.alive() and not part.process.end()
        self.network.stop()

    def program(self, name):
        return self.build / "bin" / f"cyclorama-{name}"

    def add_node(self):
        self.nodes.append(Node(self, f"node-{next(self.numbers)}"))
        return self.nodes[-1]

    def drop_node(self, node):
        """Requests that the node stops."""
        self.stuck += not node.process.end()
        self.nodes.remove(node)

    def ready(self):
        for node in self.nodes:
            wait_until(node.is_ready, 60, f"{node.name} has the scene")

    def add_museum(self, name, *options, rate_hz=RATE_HZ, size=SIZE, poses=POSES):
        """Starts a museum in place of the one of that name."""
        links = [Link(self.network, coordinator.museums) for coordinator in self.coordinators]
        museum = Museum(name, self.build / "tests" / "test-museum", self.folder, [link.address for link in links], rate_hz,
                        [*size, "--poses", poses, *options])
        museum.links, museum.requested = links, (options, {"rate_hz": rate_hz, "size": size, "poses": poses})
        if name in self.museums:
            self.past.append(self.museums[name])
        self.museums[name] = museum
        return museum

    def forget_museum(self, name):
        museum = self.museums.pop(name)
        self.stuck += not museum.end()
        self.past.append(museum)

    def wrong(self):
        """Returns the sum of Museum.wrong() over all present and former museums."""
        each = [museum.wrong() for museum in [*self.past, *self.museums.values()]]
        return sum(holes for holes, _ in each), [reason for _, breaches in each for reason in breaches]

    def pictures(self):
        """Returns the digests of whole pictures by view; more than one digest for a view is an error. The first mapping
        is for requested views, the second for visitors at rest."""
        requested, at_rest = {}, {}
        for museum in [*self.past, *self.museums.values()]:
            for frame in museum.events("frame"):
                if frame["complete"]:
                    (at_rest if frame["refined"] else requested).setdefault(frame["view_hex"], set()).add(frame["digest"])
        return requested, at_rest


def render(build, folder, scene, frames):
    """Renders the views of these frames by one undisturbed node and returns the digests by view_hex."""
    rounds = []  # Numbers of views grow within a session; other museums' sessions may have had the same ones.
    for number, view in sorted({(frame["view"], frame["view_hex"]) for frame in frames}):
        free = next((views for views in rounds if views[-1][0] < number), None)
        rounds.append([(number, view)]) if free is None else free.append((number, view))
    digests = {}
    with Farm(build, folder, nodes=1, scene=scene) as alone:
        alone.ready()
        for i, views in enumerate(rounds):
            file = pathlib.Path(folder) / f"views-{i}"
            file.write_text("".join(f"{view}\n" for _, view in views))
            museum = alone.add_museum("reference", "--views", file)
            assert museum.process.popen.wait(600) == 0, "the reference was not rendered"
            museum.reader.join()
            assert museum.wrong() == (0, []), museum.wrong()
            digests |= {frame["view_hex"]: frame["digest"] for frame in museum.whole_frames()}
    return digests
