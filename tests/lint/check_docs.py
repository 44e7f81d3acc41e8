#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Checks the documents: every relative link and its anchor exists, no line is longer than 120 columns (but for what
programs printed, between the marks of scripts/figures), and every path docs/... that a source names exists. Run: check_docs.py SOURCE_ROOT
"""
import re
import subprocess
import sys
from pathlib import Path

MAX_COLUMNS = 120
LINK = re.compile(r"\]\(([^)\s]+)\)")
NAMED = re.compile(r"\bdocs/[\w/.-]+\.(?:md|json|svg|png|jpg)(?:#([\w-]+))?")


def prose_of(text):
    """The lines of a document with its fenced blocks emptied, so that examples are no headings and no links."""
    fenced = False
    for line in text.splitlines():
        if line.startswith("```"):
            fenced = not fenced
        yield "" if fenced or line.startswith("    ") else line


def anchors_of(path):
    """The anchors that GitHub gives to a document's headings."""
    anchors, seen = set(), {}
    for line in prose_of(path.read_text()):
        heading = re.match(r"#+\s+(.*)", line)
        if not heading:
            continue
        text = re.sub(r"\[([^\]]*)\]\([^)]*\)", r"\1", heading.group(1)).strip().lower()
        anchor = re.sub(r"[^\w\- ]", "", text).replace(" ", "-")
        count = seen.get(anchor, 0)
        seen[anchor] = count + 1
        anchors.add(anchor if count == 0 else f"{anchor}-{count}")
    return anchors


def check_target(root, path, anchor):
    if not path.exists():
        return "does not exist"
    if anchor and path.suffix == ".md" and anchor not in anchors_of(path):
        return f"has no heading '{anchor}'"
    return None


def check_document(root, path):
    is_printed = False
    for number, line in enumerate(path.read_text().splitlines(), 1):
        is_printed = line.startswith("<!-- figures ") or (is_printed and line != "<!-- end of figures -->")
        if len(line) > MAX_COLUMNS and not is_printed:
            yield f"{path.relative_to(root)}:{number}: {len(line)} columns; at most {MAX_COLUMNS} are allowed"
    for number, line in enumerate(prose_of(path.read_text()), 1):
        for link in LINK.findall(line):
            if re.match(r"[a-z]+:", link):
                continue
            name, _, anchor = link.partition("#")
            target = (path.parent / name).resolve() if name else path
            wrong = check_target(root, target, anchor)
            if wrong:
                yield f"{path.relative_to(root)}:{number}: the link to '{link}' {wrong}"


def check_source(root, path):
    try:
        text = path.read_text()
    except (UnicodeDecodeError, OSError):
        return
    for number, line in enumerate(text.splitlines(), 1):
        for named in NAMED.finditer(line):
            wrong = check_target(root, root / named.group(0).partition("#")[0], named.group(1))
            if wrong:
                yield f"{path.relative_to(root)}:{number}: {named.group(0)} {wrong}"


def main():
    root = Path(sys.argv[1] if len(sys.argv) > 1 else ".").resolve()
    listed = subprocess.run(["git", "-C", root, "ls-files", "-co", "--exclude-standard"], check=True, text=True,
                            capture_output=True).stdout.split("\n")
    problems = []
    for name in filter(None, listed):
        path = root / name
        if not path.is_file():
            continue
        if path.suffix == ".md":
            problems += check_document(root, path)
        elif not name.startswith(("docs/", "tests/lint/")):
            problems += check_source(root, path)
    print("\n".join(problems) if problems else "documents: every link leads somewhere, no line is too long")
    return 1 if problems else 0


if __name__ == "__main__":
    sys.exit(main())
