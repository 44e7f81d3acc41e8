#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Writes compiled catalogues (msgfmt's .mo files) as one C++ source, each as the JSON that pages and programs read.

Run: embed_catalogues.py OUTPUT.cpp FILE.mo...

{"language": "de", "name": "Deutsch", "decimal": ",", "stop": ".", "space": " ", "plural": "1011...",
 "texts": [[one, many or "", form, ...]]}
`stop` ends a sentence, and `space` stands between two. `plural` has the number of the form for each count below 200; larger ones repeat the last hundred, as all known rules do.
"""
import gettext
import json
import pathlib
import sys

COUNTS = 200
PIECE = 8000  # Compilers need not accept longer literals.


def texts_of(path):
    """Returns the English texts of a .mo file with their translations (gettext's manual, "The Format of GNU MO Files").
    Forms of a plural are separated by a null byte."""
    data = pathlib.Path(path).read_bytes()
    order = "little" if data[:4] == b"\xde\x12\x04\x95" else "big"

    def number(at):
        return int.from_bytes(data[at:at + 4], order)

    def text(table, i):
        size, at = number(table + 8 * i), number(table + 8 * i + 4)
        return data[at:at + size].decode()

    return {text(number(12), i): text(number(16), i) for i in range(number(8))}


def catalogue(path):
    texts = texts_of(path)
    header = dict(line.split(": ", 1) for line in texts.pop("").splitlines())
    plural = gettext.c2py(header["Plural-Forms"].split("plural=")[1].rstrip(";"))
    entries = []
    for english, translated in sorted(texts.items()):
        one, _, many = english.partition("\0")
        entries.append([one, many, *translated.split("\0")])
    return {"language": header["Language"], "name": header["X-Language-Name"], "decimal": header["X-Decimal"],
            "stop": header["X-Full-Stop"], "space": header["X-Space"].strip("\""),
            "plural": "".join(str(plural(count)) for count in range(COUNTS)), "texts": entries}


def literal(text):
    pieces = [text[at:at + PIECE] for at in range(0, len(text), PIECE)]
    return "\n    ".join(f'R"json({piece})json"' for piece in pieces)


def main(output, *compiled):
    lines = ["// Made by embed_catalogues.py.", '#include "common/language/catalogues.h"', "",
             "std::vector<std::string_view> cyclorama::embedded_catalogues() {", "  return {"]
    for path in compiled:
        lines.append(f"    {literal(json.dumps(catalogue(path), ensure_ascii=False))},")
    lines += ["  };", "}", ""]
    pathlib.Path(output).write_text("\n".join(lines))


if __name__ == "__main__":
    main(*sys.argv[1:])
