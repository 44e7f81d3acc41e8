#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Runs a benchmark of tests/bench/benchmarks.toml: installs its packages, builds its programs, runs its commands.

  ./bench.sh --list                     the benchmarks
  ./bench.sh NAME [--quick] [OPTIONS]   runs one
  ./bench.sh NAME --help                its options

A benchmark prints a table for people, then one line that is a JSON object. What it printed stays in
build/figures/NAME.json with the machine, the date and the commit; `scripts/figures` makes documents of it.
CYCLORAMA_BUILD=FOLDER measures the programs of that build folder and builds nothing.
"""
import json
import os
import pathlib
import shlex
import subprocess
import sys
import tempfile
import time

try:
    import tomllib
except ImportError:
    sys.exit("bench.sh: needs Python 3.11 or newer, as Debian 12 has it")

import generated
import goals
import record

ROOT = pathlib.Path(__file__).resolve().parents[2]
KEYS = {"about", "quicker", "packages", "targets", "values", "quick", "options", "scenes", "needs", "measures", "goals", "pictures",
        "commands"}
PACKAGES = {"build", "test", "bench", "image"}
SKIPPED = 77
UNFINISHED = 75  # A later run goes on from the records that it kept.


class UsageError(Exception):
    """One sentence about what is wrong with the command line."""


def read_table(file=ROOT / "tests/bench/benchmarks.toml"):
    with open(file, "rb") as source:
        return tomllib.load(source)


def option_of(entry, word):
    """Returns the declared form of an option, such as "--seconds S", or None."""
    return next((form for form in entry.get("options", {}) if form.split()[0] == word), None)


def parse(name, entry, words):
    """Returns whether --quick was given, values that options set, and the words that the commands get as {options}."""
    is_quick, values, passed = False, {}, []
    words = list(words)
    while words:
        word, has_value, value = words.pop(0).partition("=")
        if word == "--quick" and not has_value:
            is_quick = True
            continue
        form = option_of(entry, word)
        if form is None:
            known = ", ".join(["--quick", *entry.get("options", {})])
            raise UsageError(f"{name} has no option '{word}'; it has {known}")
        if " " not in form:
            passed.append(word)
            continue
        if not has_value:
            if not words:
                raise UsageError(f"{name}: {word} needs a value: {form}")
            value = words.pop(0)
        if word[2:] in entry.get("values", {}):
            values[word[2:]] = value
        else:
            passed += [word, value]
    return is_quick, values, passed


def places(build):
    """The paths that commands name in braces."""
    return {"build": build, "bin": f"{build}/bin", "tests": f"{build}/tests",
            "shared": os.environ.get("CYCLORAMA_SHARED", "../shared")}


def command_words(command, values, lists):
    """Splits a command of the table into words; a word that is a list's name in braces becomes the list."""
    words = []
    for word in shlex.split(command):
        if word[1:-1] in lists and word == f"{{{word[1:-1]}}}":
            words += lists[word[1:-1]]
        else:
            words.append(word.format_map(values))
    return words


def prepare(entry):
    """Installs the packages and builds the targets."""
    if "CYCLORAMA_BUILD" in os.environ:
        return
    kinds = entry.get("packages", [])
    if kinds:
        if subprocess.run(["scripts/install-packages", *kinds], check=False, stdout=sys.stderr).returncode != 0:
            sys.exit(1)  # It printed why.
    if entry.get("targets"):
        # A demo on a machine without the packages for tests leaves them switched off.
        tests = ["-DCYCLORAMA_TESTS=ON"] if "test" in kinds else []
        subprocess.run(["cmake", "--preset", "release", *tests], check=True, stdout=subprocess.DEVNULL)
        subprocess.run(["cmake", "--build", "--preset", "release", "--target", *entry["targets"]], check=True,
                       stdout=sys.stderr)


def run_command(words):
    """Runs a command, passes its output on line by line, and returns its exit status and output. Words that end with
    "> FILE" write the output there."""
    if len(words) > 2 and words[-2] == ">":
        pathlib.Path(words[-1]).parent.mkdir(parents=True, exist_ok=True)
        with open(words[-1], "wb") as out:
            return subprocess.run(words[:-2], check=False, stdout=out).returncode, ""
    printed = []
    with subprocess.Popen(words, stdout=subprocess.PIPE, text=True, encoding="utf-8", errors="replace") as process:
        try:
            for line in process.stdout:
                printed.append(line)
                print(line, end="", flush=True)
        except KeyboardInterrupt:
            process.wait()
            raise
    return process.returncode, "".join(printed)


def run_commands(name, entry, values, lists):
    """Runs the commands until one fails, and returns that status and all that was printed."""
    printed = ""
    with tempfile.TemporaryDirectory() as folder:
        values = values | {"json": f"{folder}/result.json", "figures": f"{folder}/figures.json", "temporary": folder}
        for command in entry["commands"]:
            sys.stdout.flush()
            status, text = run_command(command_words(command, values, lists))
            printed += text
            if status != 0:
                break
        result = pathlib.Path(values["json"])
        if result.is_file() and result.stat().st_size > 0:
            line = json.dumps({"benchmark": name, **json.loads(result.read_text(encoding="utf-8"))}) + "\n"
            printed += line
            print(line, end="")
    return status, printed


def measure(name, entry, words):
    """Runs a benchmark, keeps its record and returns its exit status."""
    is_quick, chosen, passed = parse(name, entry, words)
    build = os.environ.get("CYCLORAMA_BUILD", "build/release")
    values = places(build) | entry.get("values", {}) | (entry.get("quick", {}) if is_quick else {}) | chosen
    needed = entry.get("needs", "").format_map(values)
    if needed and not pathlib.Path(needed).exists():
        print(f"bench.sh: {name} needs the data in {needed}, which are not there", file=sys.stderr)
        return SKIPPED
    prepare(entry)
    for kind, triangles in entry.get("scenes", {}).items():
        values[kind] = generated.scene(kind, triangles.format_map(values), f"{build}/bin")
    lists = {"quick": ["--quick"] if is_quick else [], "options": passed}
    started, load = time.time(), record.load()
    status, printed = run_commands(name, entry, values, lists)
    if status not in (SKIPPED, UNFINISHED):
        kept = record.make(name, entry, words, started, load, status, printed)
        kept["goals"] = {goal: goals.is_held(goal, kept["result"]) for goal in entry.get("goals", [])}
        record.write(kept)
        record.keep_pictures(entry, started)
    return status


def about(entry):
    return entry["about"] + (f" (--quick: {entry['quicker']})" if "quicker" in entry else "")


def explain(name, entry):
    """Prints the help of one benchmark."""
    print(f"./bench.sh {name} [--quick]{' [OPTIONS]' if entry.get('options') else ''}\n{about(entry)}")
    for form, meaning in entry.get("options", {}).items():
        print(f"  {form:<24} {meaning}")


def main(words):
    if not words or words[0] in ("-h", "--help"):
        print(__doc__.split("\n", 2)[2].rstrip())
        return 0
    table = read_table()
    if words[0] == "--list":
        for name in sorted(table):
            print(f"{name:<20} {about(table[name])}")
        return 0
    name = words[0]
    if name not in table:
        raise UsageError(f"no benchmark '{name}'; see ./bench.sh --list")
    if {"-h", "--help"} & set(words[1:]):
        explain(name, table[name])
        return 0
    os.chdir(ROOT)
    return measure(name, table[name], words[1:])


if __name__ == "__main__":
    try:
        sys.exit(main(sys.argv[1:]))
    except UsageError as error:
        print(f"bench.sh: {error}", file=sys.stderr)
        sys.exit(2)
    except subprocess.CalledProcessError as error:
        print(f"bench.sh: '{shlex.join(map(str, error.cmd))}' ended with {error.returncode}", file=sys.stderr)
        sys.exit(1)
    except FileNotFoundError as error:
        print(f"bench.sh: {error.filename} is not there", file=sys.stderr)
        sys.exit(1)
    except KeyboardInterrupt:
        sys.exit(130)
