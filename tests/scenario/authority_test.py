#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Tests cyclorama-authority in an empty folder: the files that it makes, their permissions, and what it refuses.

Run: authority_test.py BUILD_FOLDER
"""
import pathlib
import subprocess
import sys
import tarfile
import tempfile

problems = []


def expect(true, what):
    if not true:
        problems.append(what)


class Authority:
    def __init__(self, build, folder):
        self.program = str(pathlib.Path(build).resolve() / "bin" / "cyclorama-authority")
        self.folder = pathlib.Path(folder)
        self.ca = self.folder / "ca"

    def run(self, *words):
        return subprocess.run([self.program, "--folder", str(self.ca), *words], cwd=self.folder, capture_output=True, text=True,
                              timeout=30)

    def ok(self, *words):
        done = self.run(*words)
        expect(done.returncode == 0, f"{words}: {done.stderr}")
        return done.stdout

    def refuses(self, because, *words):
        done = self.run(*words)
        expect(done.returncode == 1 and because in done.stderr and done.stderr.count("\n") == 1,
               f"{words}: {done.returncode}, {done.stderr!r} instead of '{because}'")

    def openssl(self, *words):
        return subprocess.run(["openssl", *words], cwd=self.folder, capture_output=True, text=True, timeout=30).stdout

    def unpack(self, bundle):
        to = self.folder / bundle.removesuffix(".tar")
        with tarfile.open(self.folder / bundle) as tar:
            for member in tar:
                expect(member.name == pathlib.PurePath(member.name).name, f"{bundle}: {member.name} is not a plain name")
            tar.extractall(to)
        return to


def check_renewals(authority):
    """Signs what museums have requested, and nothing else; of a request only its key counts."""
    authority.refuses("has no folder 'requests'", "renewals", str(authority.folder))
    requests = authority.folder / "renewals/requests"
    requests.mkdir(parents=True)
    issued = requests.parent / "issued"

    def request(name, key="ec -pkeyopt ec_paramgen_curve:P-256"):
        authority.openssl("req", "-new", "-newkey", *key.split(), "-noenc", "-keyout", "request.key", "-out", str(requests / f"{name}.pem"), "-subj", "/OU=coordinator/CN=farm")
    for name, key in (("hall-3", "ec -pkeyopt ec_paramgen_curve:P-384"), ("n1", "ec -pkeyopt ec_paramgen_curve:P-256"), ("nobody", "ec -pkeyopt ec_paramgen_curve:P-256")):
        request(name, key)
    (requests / "farm.pem").write_text("-----BEGIN CERTIFICATE REQUEST-----\n")
    done = authority.run("renewals", str(requests.parent))
    for reason in ("'hall-3' is refused: it is no request with a key on P-256", "'n1' is refused: only museums'", "'nobody' is refused: no certificate", "'farm' is refused: only museums'"):
        expect(reason in done.stderr, f"renewals: {done.stderr!r} has no {reason!r}")
    expect(not list(issued.iterdir()) and not list(requests.iterdir()), "what is refused leaves something")
    request("hall-3")
    expect("renewed: hall-3" in authority.ok("renewals", str(requests.parent)), "hall-3 is not renewed")
    text = authority.openssl("x509", "-in", str(issued / "hall-3.crt"), "-noout", "-text")
    for part in ("OU = museum", "CN = hall-3", "TLS Web Client Authentication", "CA:FALSE"):
        expect(part in text, f"the renewed certificate has no {part}")
    expect((issued / "hall-3.crt").stat().st_mode & 0o444 == 0o444, "the coordinator cannot read what was renewed")
    request("hall-3")
    authority.ok("renewals", str(requests.parent))
    expect((requests / "hall-3.pem").exists(), "a museum got a second certificate on the same day")


def check(authority):
    authority.refuses("make one with", "list")
    authority.ok("init")
    authority.refuses("has an authority already", "init")
    authority.refuses("needs --address", "coordinator", "farm")
    authority.ok("coordinator", "farm", "--address", "::1", "--address", "farm.example.org")
    output = authority.ok("museum", "hall-3", "--scenes", "grotto,relic")
    expect('scenes = ["grotto", "relic"]' in output, output)
    authority.ok("node", "n1", "--days", "30")

    for secret in ("farm.tar", "hall-3.tar", "ca/private/ca.key"):
        expect((authority.folder / secret).stat().st_mode & 0o077 == 0, f"others may read {secret}")
    expect((authority.ca / "crl.pem").stat().st_mode & 0o444 == 0o444, "the coordinator cannot read crl.pem")
    coordinator = authority.unpack("farm.tar")
    expect((coordinator / "key.pem").stat().st_mode & 0o077 == 0, "others may read the coordinator's key")
    expect('revoked = "' in (coordinator / "settings.toml").read_text(), "the coordinator's lines name no revocation list")
    museum = authority.unpack("hall-3.tar")
    expect("[farm]" in (museum / "settings.toml").read_text(), "the museum's lines are not for site.toml")
    text = authority.openssl("x509", "-in", str(coordinator / "certificate.crt"), "-noout", "-text")
    for part in ("CN = farm", "OU = coordinator", "DNS:farm.example.org", "IP Address:0:0:0:0:0:0:0:1", "TLS Web Server Authentication",
                 "CA:FALSE", "prime256v1"):
        expect(part in text, f"the coordinator's certificate has no {part}")
    verified = authority.openssl("verify", "-x509_strict", "-purpose", "sslclient", "-CAfile", str(authority.ca / "ca.crt"),
                                 str(museum / "certificate.crt"))
    expect(verified.endswith("OK\n"), f"openssl verify: {verified}")

    authority.refuses("has a valid certificate", "museum", "hall-3")
    authority.refuses("is there already", "renew", "hall-3")
    authority.ok("renew", "hall-3", "--output", "next.tar")
    expect((authority.unpack("next.tar") / "key.pem").read_text() != (museum / "key.pem").read_text(), "renewed with the old key")
    authority.ok("revoke", "hall-3")
    revoked = authority.openssl("crl", "-in", str(authority.ca / "crl.pem"), "-noout", "-text")
    expect(revoked.count("Serial Number:") == 2, "both of hall-3's certificates are revoked")
    authority.refuses("no valid certificate of 'hall-3'", "revoke", "hall-3")
    authority.refuses("is revoked", "renew", "hall-3")
    authority.ok("museum", "hall-3", "--replace")
    listed = authority.ok("list").splitlines()
    expect(len(listed) == 6 and sum("revoked" in line for line in listed) == 2, "\n".join(listed))

    check_renewals(authority)
    authority.refuses("is not a name", "museum", "../hall")
    authority.refuses("is not a name", "node", "a/CN=b")
    authority.refuses("neither an IP address nor", "coordinator", "farm2", "--address", "a,DNS:b")
    authority.refuses("not a list", "museum", "x", "--scenes", 'a"b')
    authority.refuses("no command", "frobnicate")
    authority.refuses("no option", "--frobnicate")
    authority.refuses("needs a value", "node", "x", "--days")
    expect(not list(authority.folder.glob("x*")), "a refusal left files")


def main(build):
    with tempfile.TemporaryDirectory() as folder:
        check(Authority(build, folder))
    print("\n".join(problems) or "authority: ok")
    return 1 if problems else 0


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
