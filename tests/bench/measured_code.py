# SPDX-License-Identifier: Apache-2.0
"""Which files of the tree a benchmark measures: sources of its targets and all that these include, its scripts and all
that these import. A digest of them tells whether a figure is older than the code that it measures."""
import functools
import hashlib
import pathlib
import re
import sys

ROOT = pathlib.Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "tests/lint"))
import cxx_text  # noqa: E402

TOPS = ("common", "drivers", "renderfarm", "appliance", "kiosk", "tests")
TARGET = re.compile(r"(?:add_executable\(|project_(?:program|bench)\(\s*NAME\s+)([\w.-]+)([^()]*)")
INCLUDE = re.compile(r'^\s*#\s*include\s+"([^"]+)"', re.M)
IMPORT = re.compile(r"^\s*(?:import|from)\s+(\w+)", re.M)
CODE = (".cpp", ".h", ".py", ".sh", ".proto", ".toml", ".conf", ".service")
SCRIPT = re.compile(r"(?:tests|scripts)/[\w./-]+")


@functools.cache
def sources_of_targets():
    """Maps each program of the CMake lists to its sources."""
    found = {}
    for top in TOPS:
        for lists in (ROOT / top).rglob("CMakeLists.txt"):
            for name, words in TARGET.findall(lists.read_text(encoding="utf-8")):
                words = words.replace("${PROJECT_SOURCE_DIR}", str(ROOT)).split()
                files = [lists.parent / word for word in words if word.endswith(".cpp")]  # An absolute word stays alone.
                found[name] = [file.relative_to(ROOT).as_posix() for file in files if file.is_file()]
    return found


@functools.cache
def text_of(name):
    return (ROOT / name).read_text(encoding="utf-8", errors="replace")


@functools.cache
def includes_of(name):
    """The tree's files that a source includes; those beside it are named without their folder in some tests."""
    found = []
    for included in INCLUDE.findall(text_of(name)):
        beside = (pathlib.PurePosixPath(name).parent / included).as_posix()
        found += [file for file in (included, beside) if (ROOT / file).is_file()][:1]
    return found


@functools.cache
def sources_of_header(name):
    """The sources that implement a header: the one of its name, and those beside it that include it and have no header
    of their own."""
    path = ROOT / name
    found = []
    for source in path.parent.glob("*.cpp"):
        has_header = source.with_suffix(".h").is_file()
        if source.stem == path.stem or (not has_header and name in includes_of(source.relative_to(ROOT).as_posix())):
            found.append(source.relative_to(ROOT).as_posix())
    return [source for source in found if not source.endswith("_main.cpp")]


def modules_of(name):
    """The Python files of the tree that a script imports; they lie beside it or in tests/bench."""
    for module in IMPORT.findall(text_of(name)):
        for folder in (pathlib.PurePosixPath(name).parent, pathlib.PurePosixPath("tests/bench"),
                       pathlib.PurePosixPath("tests/scenario")):
            file = (folder / f"{module}.py").as_posix()
            if (ROOT / file).is_file():
                yield file
                break


def files_below(place):
    """The sources and scripts in a folder of the tree, or that one file."""
    path = ROOT / place
    found = [path] if path.is_file() else path.rglob("*")
    return sorted(file.relative_to(ROOT).as_posix() for file in found
                  if file.is_file() and (file.suffix in CODE or file.suffix == "") and "__pycache__" not in file.parts)


def files_of(entry):
    """Every file of the tree that an entry of benchmarks.toml measures, sorted."""
    waiting = [source for target in entry.get("targets", []) for source in sources_of_targets().get(target, [])]
    waiting += [word for command in entry["commands"] for word in SCRIPT.findall(command) if (ROOT / word).is_file()]
    waiting += [file for place in entry.get("measures", []) for file in files_below(place)]
    seen = set()
    while waiting:
        name = waiting.pop()
        if name in seen:
            continue
        seen.add(name)
        if name.endswith(".cpp"):
            waiting += includes_of(name)
        elif name.endswith(".h"):
            waiting += includes_of(name) + sources_of_header(name)
        elif name.endswith(".py"):
            waiting += modules_of(name)
    return sorted(seen)


@functools.cache
def code_of(name):
    """A file's code without comments and blanks, so that better words make no figure old."""
    text = text_of(name)
    if name.endswith((".cpp", ".h")):
        text = "".join(piece for kind, _, piece in cxx_text.pieces(text) if kind != "comment")
    return " ".join(text.split())


def digest_of(entry):
    """A short digest of the code that an entry measures."""
    digest = hashlib.sha256()
    for name in files_of(entry):
        digest.update(f"{name}\0{code_of(name)}\0".encode())
    return digest.hexdigest()[:16]
