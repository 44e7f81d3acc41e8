# SPDX-License-Identifier: Apache-2.0
"""A farm on the host: an authority, a coordinator and a node, to which the computer in QEMU connects over IPv6."""
import pathlib
import subprocess
import time

# In QEMU's network this address is the host's loopback, seen from the guest.
HOST_FROM_WITHIN = "fec0::2"
MUSEUMS, NODES = 7401, 17402
TRIANGLES = 10000
MUSEUM = "hall-3"


class HostFarm:
    def __init__(self, programs, folder, addresses=(HOST_FROM_WITHIN, "::1"), more=""):
        """The coordinator's certificate is for these addresses. `more` is added to farm.toml before the tables."""
        self.programs = pathlib.Path(programs).resolve()
        self.folder = pathlib.Path(folder)
        self.folder.mkdir(parents=True, exist_ok=True)
        self.running = []
        self._run("cyclorama-grotto", "--triangles", TRIANGLES, "--out", self.folder / "scene", "--force")
        self._authority("init")
        of_coordinator = [word for address in addresses for word in ("--address", address)]
        for role, *words in (("coordinator", "farm", *of_coordinator), ("node", "node"), ("museum", MUSEUM)):
            self._authority("--output", self.folder / f"{role}.tar", role, *words)
            (self.folder / role).mkdir(exist_ok=True)
            subprocess.run(["tar", "-xf", self.folder / f"{role}.tar", "-C", self.folder / role], check=True)
        (self.folder / "farm.toml").write_text(
            f'museums = "[::1]:{MUSEUMS}"\nnodes = "[::1]:{NODES}"\n{more}[[scene]]\nname = "grotto"\npath = "{self.folder}/scene"\n' + self._tls("coordinator"))
        (self.folder / "node.toml").write_text(f'coordinators = ["[::1]:{NODES}"]\nname = "node"\nthreads = 1\n' + self._tls("node"))

    def _run(self, program, *arguments):
        subprocess.run([self.programs / program, *map(str, arguments)], check=True, stdout=subprocess.DEVNULL)

    def _authority(self, *arguments):
        self._run("cyclorama-authority", "--folder", self.folder / "authority", *arguments)

    def _tls(self, role):
        at = self.folder / role
        return f'[tls]\nauthority = "{at}/authority.crt"\ncertificate = "{at}/certificate.crt"\nkey = "{at}/key.pem"\n'

    def on_stick(self):
        """Returns {path on a museum's stick: file} of the museum's certificates."""
        return {f"cyclorama/tls/{name}": self.folder / "museum" / name for name in ("authority.crt", "certificate.crt", "key.pem")}

    def site(self):
        """Returns a site.toml with slow turns and long timeouts: an emulated computer needs seconds for a picture."""
        return (f'[farm]\ncoordinators = ["[{HOST_FROM_WITHIN}]:{MUSEUMS}"]\nmuseum = "{MUSEUM}"\nauthority = "tls/authority.crt"\n'
                'certificate = "tls/certificate.crt"\nkey = "tls/key.pem"\n[picture]\nsamples = 1\njpeg_quality = 70\n'
                '[walk]\nturn_deg_per_s = 5\nguide_after_s = 0\n[display]\nattract_after_s = 90\n')

    def start(self):
        for program, settings in (("cyclorama-farm", "farm.toml"), ("cyclorama-node", "node.toml")):
            log = open(self.folder / f"{program}.log", "a")
            self.running.append(subprocess.Popen([self.programs / program, "--config", self.folder / settings], stdout=log, stderr=log))
        time.sleep(1)
        if any(process.poll() is not None for process in self.running):
            raise RuntimeError("the farm ended: " + "".join(path.read_text()[-1000:] for path in self.folder.glob("*.log")))

    def stop(self):
        for process in self.running:
            process.kill()
            process.wait()
        self.running.clear()
