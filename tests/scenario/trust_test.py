#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Tests a farm with certificates, with real processes: a museum visits a granted scene, loses the grant, is revoked
during a session and returns with a new certificate, all without a restart.

Run: trust_test.py BUILD_FOLDER
"""
import json
import pathlib
import subprocess
import sys
import tempfile
import time

sys.path.insert(0, str(pathlib.Path(__file__).parent))
from farm.authority import TLS, Authority  # noqa: E402
from farm.farm import make_scene  # noqa: E402
from farm.museum import Museum  # noqa: E402
from farm.processes import Process, free_port, wait_until  # noqa: E402


class TrustedFarm:
    def __init__(self, build, folder):
        self.bin, self.folder = pathlib.Path(build) / "bin", pathlib.Path(folder)
        self.audit_file = self.folder / "audit.jsonl"
        self.museums, self.nodes = free_port(), free_port()
        self.running = []
        self.authority = Authority(build, folder)
        self.authority.bundle("coordinator", "farm", "--address", "::1")
        self.authority.bundle("node", "n1")
        self.authority.bundle("museum", "hall-3")
        self.authority.bundle("museum", "hall-4")
        self.grant("visit")
        scene = make_scene(build, folder)
        (self.folder / "farm.toml").write_text(
            f'museums = "[::]:{self.museums}"\nnodes = "[::]:{self.nodes}"\nmuseums_file = "museums.toml"\n'
            f'audit = "audit.jsonl"\n[[scene]]\nname = "visit"\npath = "{scene}"\n[tls]\nrevoked = "ca/crl.pem"\n'
            + TLS.format("farm"))
        (self.folder / "node.toml").write_text(
            f'coordinator = "[::1]:{self.nodes}"\nthreads = 1\n[tls]\n' + TLS.format("n1"))
        (self.folder / "site.toml").write_text(
            f'[farm]\ncoordinators = ["[::1]:{self.museums}"]\n' + TLS.format("hall-3"))
        self.start("farm", "farm.toml")
        self.start("node", "node.toml")
        self.start("tour", "site.toml", "--listen", f"[::1]:{free_port()}")
        self.walker = Museum("walker", pathlib.Path(build) / "tests" / "test-museum", folder, [f"[::1]:{self.museums}"], 10,
                             ["--bundle", self.folder / "hall-4", "--width", 256, "--height", 128])
        self.running.append(self.walker.process)

    def grant(self, scene):
        """Grants a scene to hall-3; hall-4 may see all."""
        new = self.folder / "museums.new"
        new.write_text(f'[[museum]]\nname = "hall-3"\nscenes = ["{scene}"]\nfree_eye = true\n'
                       '[[museum]]\nname = "hall-4"\nscenes = ["*"]\nfree_eye = true\n')
        new.rename(self.folder / "museums.toml")

    def start(self, name, config, *options):
        command = [self.bin / f"cyclorama-{name}", "--config", self.folder / config, *options]
        self.running.append(Process(name, command, self.folder))

    def audit(self):
        return [json.loads(line) for line in self.audit_file.read_text().splitlines()] if self.audit_file.exists() else []

    def wait_for(self, count, event, **fields):
        """Waits until so many lines match. Returns the last of them and the seconds."""
        def like():
            return [line for line in self.audit() if line["event"] == event and all(
                value in line.get(key, "") for key, value in fields.items())]
        began = time.monotonic()
        wait_until(lambda: len(like()) >= count, 60, f"{count} x {event} {fields}")
        return like()[-1], time.monotonic() - began

    def tls(self, version, name):
        here = self.folder / name
        return subprocess.run(["openssl", "s_client", version, "-alpn", "h2", "-connect", f"[::1]:{self.museums}", "-CAfile",
                               here / "authority.crt", "-cert", here / "certificate.crt", "-key", here / "key.pem"],
                              stdin=subprocess.DEVNULL, capture_output=True, text=True, errors="replace", timeout=30).stdout

    def stop(self):
        return all([process.end() for process in reversed(self.running)])


def check(farm):
    opened, _ = farm.wait_for(1, "session opened", name="hall-3", scene="visit")
    assert opened["role"] == "museum" and "[::1]" in opened["address"].replace("%5B", "[").replace("%5D", "]"), opened
    assert "Cipher is (NONE)" in farm.tls("-tls1_2", "hall-3"), "TLS 1.2 is accepted"
    assert "TLSv1.3, Cipher is TLS_" in farm.tls("-tls1_3", "hall-3"), "TLS 1.3 is refused"

    farm.grant("another")
    farm.wait_for(1, "session ended", reason="not granted any more")
    farm.grant("visit")
    farm.wait_for(2, "session opened", name="hall-3")

    farm.authority.do("revoke", "hall-3")
    ended, museum_s = farm.wait_for(1, "session ended", reason="revoked")
    assert ended["serial"] == opened["serial"], ended
    farm.wait_for(1, "museum refused", serial=opened["serial"], reason="revoked")
    farm.authority.bundle("museum", "hall-3")
    again, _ = farm.wait_for(3, "session opened", name="hall-3")
    assert again["serial"] != opened["serial"], again

    assert farm.walker.wrong() == (0, []) and len(farm.walker.events("opened")) == 1, "one affects another"
    farm.authority.do("revoke", "n1")
    _, node_s = farm.wait_for(1, "node gone", reason="revoked")
    assert all(process.alive() for process in farm.running), "a process was restarted"
    assert farm.stop(), "a process did not stop on request"
    walked, _ = farm.wait_for(1, "session ended", name="hall-4")
    assert walked["frames"] > 10 and walked["bytes"] > 1000 * walked["frames"], walked
    print(f"a revoked museum was gone after {museum_s:.2f} s, a node after {node_s:.2f} s")


def main(build):
    with tempfile.TemporaryDirectory() as folder:
        farm = TrustedFarm(build, folder)
        try:
            check(farm)
        except AssertionError as error:
            for process in farm.running:
                print(f"{process.name}:\n{process.output()[-2000:]}")
            print(f"{farm.audit()}\n{error}")
            return 1
        finally:
            farm.stop()
    print("trust: ok")
    return 0


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
