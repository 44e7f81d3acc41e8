#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Tests the keys that sign an image: those for shipping sign no Debug image, none lies in the source tree, a token may
hold them, and while they are changed both are trusted.

Run: signing_test.py SOURCE_ROOT
"""
import os
import pathlib
import shutil
import subprocess
import sys
import tempfile

PIN = "1234"


class Tests:
    def __init__(self, source, folder):
        self.source, self.folder, self.bad = source, folder, 0
        self.environment = os.environ | {"HOME": str(folder), "XDG_DATA_HOME": str(folder / "share")}

    def run(self, script, *arguments):
        done = subprocess.run([str(self.source / "image" / script), *map(str, arguments)], capture_output=True, text=True,
                              env=self.environment, check=False)
        return done.returncode, done.stdout + done.stderr

    def expect(self, what, is_so, found=""):
        print(f"{'ok' if is_so else 'FAILED'}: {what} {'' if is_so else found}")
        self.bad += not is_so

    def refused(self, what, word, script, *arguments):
        status, output = self.run(script, *arguments)
        self.expect(f"{what} is refused", status == 1 and word in output, output)

    def purposes(self):
        for purpose in ("development", "shipping"):
            status, output = self.run("signing", "make", purpose, self.folder / purpose)
            self.expect(f"keys for {purpose} are made", status == 0, output)
            self.expect("and nobody else can read them", all(key.stat().st_mode & 0o77 == 0
                                                             for key in (self.folder / purpose).glob("*.key")))
            self.expect("they sign an image", self.run("signing", "check", self.folder / purpose)[0] == 0)
        development, shipping = self.folder / "development", self.folder / "shipping"
        self.expect("keys for development sign a Debug image", self.run("signing", "check", development, "--debug")[0] == 0)
        self.refused("a Debug image with keys for shipping", "a Debug image is not signed with keys for shipping", "signing", "check", shipping, "--debug")
        self.refused("building it", "a Debug image is not signed with keys for shipping", "build", "--debug", "--keys", shipping)
        before = {file.name: file.read_bytes() for file in shipping.iterdir()}
        self.run("signing", "make", "development", shipping)
        self.expect("making keys leaves those that are there", before == {file.name: file.read_bytes() for file in shipping.iterdir()})
        mixed = self.folder / "mixed"
        shutil.copytree(development, mixed)
        for name in ("boot.key", "boot.crt"):
            shutil.copy(shipping / name, mixed)
        self.refused("a mixture of both", "mixes keys", "signing", "check", mixed, "--debug")
        hidden = self.folder / "hidden"
        shutil.copytree(development, hidden)
        shutil.copytree(shipping, hidden / "previous")
        self.refused("a Debug image with previous keys for shipping", "a Debug image is not signed", "signing", "check", hidden, "--debug")
        (mixed / "measure.crt").unlink()
        self.refused("a folder without a key", "has no measure.crt", "signing", "check", mixed)
        subprocess.run(["openssl", "req", "-x509", "-newkey", "rsa:2048", "-nodes", "-subj", "/CN=Somebody", "-keyout", mixed / "measure.key", "-out", mixed / "measure.crt"], check=True, capture_output=True)
        self.refused("a key without a purpose", "does not say whether", "signing", "check", mixed)
        self.refused("another purpose", "not for 'testing'", "signing", "make", "testing", self.folder / "x")

    def places(self):
        for inside in (self.source / "image/keys", self.source / "build/keys", self.source):
            self.refused(f"a folder in the source tree ({inside.name})", "in the source tree", "signing", "make", "development", inside)
        link = self.folder / "link"
        link.symlink_to(self.source / "image")
        self.refused("a link to one", "in the source tree", "signing", "check", link)
        self.refused("an image with such keys", "in the source tree", "build", "--keys", self.source / "image/keys")
        tracked = subprocess.run(["git", "-C", self.source, "grep", "-lI", "-e", "BEGIN.*PRIVATE" + " KEY", "--", "image"], capture_output=True, text=True, check=False).stdout
        self.expect("the image's files contain no private key", tracked == "", tracked)

    def verify(self, keys, manifest, signature):
        public = self.folder / "public.pem"
        public.write_bytes(subprocess.run(["openssl", "x509", "-in", keys / "update.crt", "-noout", "-pubkey"], check=True, capture_output=True).stdout)
        return subprocess.run(["openssl", "dgst", "-sha256", "-verify", public, "-signature", signature, manifest], capture_output=True, check=False).returncode == 0

    def rotation(self):
        old, new = self.folder / "old", self.folder / "new"
        self.run("signing", "make", "shipping", old)
        self.run("signing", "make", "shipping", new)
        shutil.copytree(old, new / "previous")
        manifest, signature = self.folder / "SHA256SUMS", self.folder / "SHA256SUMS.sig"
        manifest.write_text("0 a\n")
        status, output = self.run("signing", "manifest", new, manifest, signature)
        self.expect("while keys are changed, computers with the old key accept an update", status == 0 and self.verify(old, manifest, signature), output)
        self.expect("which brings both keys", self.run("signing", "trusted", new)[1].count("BEGIN PUBLIC KEY") == 2)
        shutil.rmtree(new / "previous")
        self.run("signing", "manifest", new, manifest, signature)
        self.expect("later ones are signed with the new key", self.verify(new, manifest, signature) and not self.verify(old, manifest, signature))
        shutil.copy(old / "update.key", new)
        self.refused("a key of another certificate", "does not belong to", "signing", "manifest", new, manifest, signature)

    def token(self):
        keys = self.folder / "token"
        self.run("signing", "make", "shipping", keys)
        (self.folder / "tokens").mkdir()
        settings = self.folder / "softhsm2.conf"
        settings.write_text(f"directories.tokendir = {self.folder / 'tokens'}\n")
        self.environment["SOFTHSM2_CONF"] = str(settings)
        for words in (["--init-token", "--free", "--label", "cyclorama", "--so-pin", PIN, "--pin", PIN],
                      ["--import", keys / "update.key", "--token", "cyclorama", "--label", "update", "--id", "01", "--pin", PIN]):
            subprocess.run(["softhsm2-util", *map(str, words)], env=self.environment, check=True, capture_output=True)
        (keys / "update.key").unlink()
        self.refused("a key that is nowhere", "has no update.key", "signing", "check", keys)
        (keys / "update.uri").write_text(f"pkcs11:token=cyclorama;object=update;type=private;pin-value={PIN}\n")
        self.expect("a key on a token is a key", self.run("signing", "check", keys)[0] == 0)
        manifest, signature = self.folder / "SHA256SUMS", self.folder / "token.sig"
        status, output = self.run("signing", "manifest", keys, manifest, signature)
        self.expect("a key on a token signs an update", status == 0 and self.verify(keys, manifest, signature), output)
        (keys / "update.uri").write_text(f"pkcs11:token=away;object=update;type=private;pin-value={PIN}\n")
        self.refused("a token that is not there", "the token does not sign", "signing", "manifest", keys, manifest, signature)


def main(source):
    with tempfile.TemporaryDirectory() as folder:
        tests = Tests(pathlib.Path(source).resolve(), pathlib.Path(folder))
        tests.purposes()
        tests.places()
        tests.rotation()
        if shutil.which("softhsm2-util"):
            tests.token()
        else:
            print("skipped: keys on a token; scripts/install-packages test installs SoftHSM")
    print("signing: ok" if tests.bad == 0 else f"signing: {tests.bad} failed")
    return 1 if tests.bad else 0


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
