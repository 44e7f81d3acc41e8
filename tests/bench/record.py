# SPDX-License-Identifier: Apache-2.0
"""The record of a benchmark's run: one JSON file with the machine, the date, the commit, what was printed and the figures.

A run writes build/figures/NAME.json, a quick one NAME.quick.json. `scripts/figures --take` copies records to
docs/figures, from which it makes the tables of the documents.
"""
import datetime
import json
import os
import pathlib
import platform
import re
import shutil
import subprocess

import measured_code

ROOT = pathlib.Path(__file__).resolve().parents[2]
FRESH = ROOT / "build/figures"
KEPT = ROOT / "docs/figures"


def git(*words):
    done = subprocess.run(["git", "-C", ROOT, *words], capture_output=True, text=True, check=False)
    return done.stdout.strip() if done.returncode == 0 else ""


def first_match(pattern, file):
    try:
        found = re.search(pattern, pathlib.Path(file).read_text(encoding="utf-8"), re.M)
    except OSError:
        return ""
    return found[1].strip() if found else ""


def machine():
    """What a figure depends on, and what names nobody's computer."""
    memory_kib = first_match(r"^MemTotal:\s+(\d+)", "/proc/meminfo")
    return {"processor": first_match(r"^model name\s*:\s*(.*)$", "/proc/cpuinfo") or platform.machine(),
            "cores": len(os.sched_getaffinity(0)),
            "memory_gib": round(int(memory_kib or 0) / 2**20),
            "system": first_match(r'^PRETTY_NAME="?([^"\n]*)', "/etc/os-release")}


def load():
    """Processes that waited for a core in the last minute: what ran beside a benchmark before it began."""
    return round(os.getloadavg()[0], 1)


def last_json(printed):
    """The figures: the last line that is a JSON object, and the text before it."""
    lines = printed.rstrip("\n").split("\n")
    for at in range(len(lines) - 1, -1, -1):
        if lines[at].startswith("{"):
            try:
                return json.loads(lines[at]), "\n".join(lines[:at]).strip("\n")
            except ValueError:
                continue
    return {}, printed.strip("\n")


def make(name, entry, words, started, load_before, status, printed):
    """The record of one run."""
    result, text = last_json(printed)
    result.pop("benchmark", None)
    now = datetime.datetime.now(datetime.timezone.utc)
    return {"benchmark": name, "options": list(words), "date": now.strftime("%Y-%m-%d %H:%M UTC"),
            "seconds": round(now.timestamp() - started), "commit": git("rev-parse", "--short=12", "HEAD"),
            "is_changed": bool(git("status", "--porcelain", "--untracked-files=no")), "code": measured_code.digest_of(entry),
            "machine": machine(), "load_before": load_before, "status": status, "result": result, "printed": text}


def write(record):
    """Writes a fresh record into build/figures; one of a quick run beside that of a whole one. Returns its file."""
    quick = ".quick" if "--quick" in record["options"] else ""
    return write_to(FRESH / f"{record['benchmark']}{quick}.json", record)


def keep(record):
    """Writes a record into docs/figures."""
    return write_to(KEPT / f"{record['benchmark']}.json", record)


def write_to(file, record):
    """Writes a record whole or not at all, and returns its file."""
    file.parent.mkdir(parents=True, exist_ok=True)
    part = file.with_suffix(".part")
    part.write_text(json.dumps(record, indent=1, ensure_ascii=False) + "\n", encoding="utf-8")
    part.replace(file)
    return file


def keep_pictures(entry, started):
    """Keeps the pictures that a run has made beside its record."""
    for name, source in entry.get("pictures", {}).items():
        file = ROOT / source
        if file.is_file() and file.stat().st_mtime >= started:
            FRESH.mkdir(parents=True, exist_ok=True)
            shutil.copyfile(file, FRESH / name)


def read(file):
    return json.loads(pathlib.Path(file).read_text(encoding="utf-8"))
