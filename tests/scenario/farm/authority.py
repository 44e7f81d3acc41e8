# SPDX-License-Identifier: Apache-2.0
"""Makes a farm's certificates as its operator would."""
import pathlib
import subprocess

TLS = 'authority = "{0}/authority.crt"\ncertificate = "{0}/certificate.crt"\nkey = "{0}/key.pem"\n'


class Authority:
    """An authority in FOLDER/ca with a revocation list. Each bundle is unpacked in FOLDER/NAME."""

    def __init__(self, build, folder):
        self.program = (pathlib.Path(build) / "bin" / "cyclorama-authority").resolve()
        self.folder = pathlib.Path(folder)
        self.do("init")

    def do(self, *words):
        subprocess.run([self.program, "--folder", "ca", *words], cwd=self.folder, check=True, capture_output=True,
                       timeout=60)

    def bundle(self, role, name, *words):
        """Makes a certificate and unpacks it over the previous one of that name."""
        self.do(role, name, *words, "--replace")
        (self.folder / name).mkdir(exist_ok=True)
        subprocess.run(["tar", "-xf", f"{name}.tar", "-C", name], cwd=self.folder, check=True)
