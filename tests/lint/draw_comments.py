#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Draws comments of the product's headers and sources at random, for a reading by fresh eyes.

A reader who does not know the code counts the comments at which they stop: a sentence that has to be read twice, a
word that only we use, a pronoun without a noun. At most 3 of 60 is good. Each comment is printed with the code that
follows it. The same seed over the same sources draws the same comments. Licence lines, the comments that close a
namespace and those for tools are left out.

Run: draw_comments.py [SOURCE_ROOT] --seed N [--count 60] [--under FOLDER] [--code LINES]
"""
import argparse
import pathlib
import random
import re
import sys

import check_words
import cxx_text

PRODUCT = ("common/", "drivers/", "renderfarm/", "appliance/", "kiosk/")
NO_TEXT = re.compile(r"\s*((unnamed |anonymous )?namespace\b.{0,60}|clang-format (on|off)|NOLINT.*)\s*")


def comments(tree):
    """(file, line, comment's lines, lines of the file) of every comment that is text, in the order of the tree."""
    for name, text in tree.of(check_words.CXX):
        if not name.startswith(PRODUCT):
            continue
        lines = text.split("\n")
        for line, block in cxx_text.comment_blocks(text):
            if "SPDX-License-Identifier" in block[0]:
                line, block = line + 1, block[1:]
            if block and not NO_TEXT.fullmatch(" ".join(part.strip() for part in block)):
                yield name, line, block, lines


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("root", nargs="?", default=str(check_words.HERE.parents[1]))
    parser.add_argument("--seed", type=int, required=True)
    parser.add_argument("--count", type=int, default=60)
    parser.add_argument("--under", default="", help="only the files in this folder")
    parser.add_argument("--code", type=int, default=2, help="lines of code to print after each comment")
    options = parser.parse_args()
    every = list(comments(check_words.Tree(options.root, options.under)))
    if options.count < 1 or options.code < 0:
        parser.error("--count is at least 1, --code at least 0")
    count = min(options.count, len(every))
    drawn = sorted(random.Random(options.seed).sample(range(len(every)), count))
    for number, at in enumerate(drawn, 1):
        name, line, block, lines = every[at]
        print(f"{number}. {name}:{line}")
        print("\n".join(lines[line - 1:line - 1 + len(block) + options.code]), end="\n\n")
    print(f"{count} of {len(every)} comments, seed {options.seed}")
    return 0


if __name__ == "__main__":
    sys.exit(main())
