#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Whether scripts/check-changes finds what changed, in any clone. Run: check_changes_test.py"""
import importlib.machinery
import importlib.util
import pathlib
import subprocess
import tempfile

SCRIPT = pathlib.Path(__file__).resolve().parents[2] / "scripts/check-changes"
LOADER = importlib.machinery.SourceFileLoader("check_changes", str(SCRIPT))


def script_in(root):
    spec = importlib.util.spec_from_loader("check_changes", LOADER)
    module = importlib.util.module_from_spec(spec)
    LOADER.exec_module(module)
    module.ROOT = root
    return module


def git(root, *words):
    identity = ["-c", "user.name=a", "-c", "user.email=a@example.org", "-c", "init.defaultBranch=main"]
    done = subprocess.run(["git", "-C", root, *identity, *words], capture_output=True, text=True, check=True)
    return done.stdout.strip()


def commit(root, text):
    (root / "a.cpp").write_text(text, encoding="utf-8")
    git(root, "add", "a.cpp")
    git(root, "commit", "--quiet", "--message", "A change")
    return git(root, "rev-parse", "HEAD")


def main():
    with tempfile.TemporaryDirectory() as folder:
        origin, clone, shallow = (pathlib.Path(folder) / name for name in ("origin", "clone", "shallow"))
        origin.mkdir()
        git(origin, "init", "--quiet")
        first = commit(origin, "int a;\n")
        assert script_in(origin).find_base() is None, "one commit has nothing before it"
        second = commit(origin, "int a;\nint b;\n")
        assert script_in(origin).find_base() == first, "without an origin: the commits that there are"
        git(origin, "clone", "--quiet", origin, clone)
        assert script_in(clone).find_base() == first, "everything is pushed: the last commits"
        commit(clone, "int a;\nint c;\nint d;\n")
        (clone / "a.cpp").write_text("int a;\nint c;\nint d;\n\nint e;\n", encoding="utf-8")
        script = script_in(clone)
        assert script.find_base() == second, "two commits ahead: where the branch left"
        assert script.changed_lines(second) == {"a.cpp": [[2, 5]]}, script.changed_lines(second)
        git(origin, "clone", "--quiet", "--depth", "1", f"file://{origin}", shallow)
        assert script_in(shallow).find_base() is None, "a shallow clone knows one commit"
        for number in range(30):
            last = commit(origin, f"int a{number};\n")
        assert script_in(origin).find_base() == git(origin, "rev-parse", f"{last}~20")
    print("check_changes: finds what changed")


if __name__ == "__main__":
    main()
