#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Checks how documents are made from records, and which code a benchmark measures. Run: figures_test.py"""
import contextlib
import importlib.machinery
import importlib.util
import io
import pathlib
import sys
import tempfile
import unittest

sys.dont_write_bytecode = True
ROOT = pathlib.Path(__file__).resolve().parents[2]


def script(name):
    """A script of scripts/ as a module."""
    loader = importlib.machinery.SourceFileLoader(name, str(ROOT / "scripts" / name))
    module = importlib.util.module_from_spec(importlib.util.spec_from_loader(name, loader))
    loader.exec_module(module)
    return module


figures = script("figures")
nightly = script("nightly")
MEASURED = {"benchmark": "one", "options": [], "date": "2026-01-02 03:04 UTC", "seconds": 7, "commit": "abc", "is_changed": False,
            "code": "d", "machine": {"processor": "P", "cores": 2, "memory_gib": 24, "system": "Debian"}, "load_before": 0.1,
            "status": 0, "result": {"a": {"b": 2}}, "printed": "a table", "goals": {"a.b <= 3": True, "a.b <= 1": False}}
BY_HAND = {"benchmark": "two", "taken_over": True, "machine": "the old one", "date": "2025-01-01", "commit": "old",
           "parts": {"first": "| a |\n|---|"}}
PAGE = pathlib.Path("docs") / "page.md"


class Blocks(unittest.TestCase):
    def fill(self, text, homes=None):
        return figures.filled(text, {"one": MEASURED, "two": BY_HAND}, PAGE, {} if homes is None else homes)

    def test_a_block_gets_what_was_printed_and_where(self):
        text = self.fill("before\n<!-- figures one -->\nold\n<!-- end of figures -->\nafter\n")
        self.assertIn("```text\na table\n```", text)
        self.assertIn("`./bench.sh one`: P, 2 cores, 24 GiB, Debian; 2026-01-02 03:04 UTC, commit abc", " ".join(text.split()))
        self.assertIn("goal `a.b <= 1`: **missed**", text)
        self.assertNotIn("old\n", text)
        self.assertEqual(text, self.fill(text))

    def test_figures_of_people_stay_until_they_are_measured(self):
        text = self.fill("<!-- figures two/first -->\n<!-- end of figures -->\n<!-- figures three -->\n<!-- end of figures -->\n")
        self.assertIn("| a |", text)
        self.assertIn("from before there were records", " ".join(text.split()))
        self.assertIn("Not measured yet: `./bench.sh three`", text)

    def test_a_record_is_whole_in_one_place(self):
        block = "<!-- figures one/a -->\n<!-- end of figures -->\n"
        text = self.fill(block + block)
        self.assertEqual(text.count("a table"), 1)
        self.assertIn("[its figures](page.md)", text)
        self.assertIn("[its figures](figures.md)", self.fill(block, {"one": pathlib.Path("docs") / "figures.md"}))

    def test_mistakes_are_one_sentence(self):
        with self.assertRaisesRegex(figures.FiguresError, "no part 'other'; it has first"):
            self.fill("<!-- figures two/other -->\n<!-- end of figures -->\n")
        with self.assertRaisesRegex(figures.FiguresError, "has no end"):
            self.fill("<!-- figures two/first -->\n")


class Taking(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        for name in ("FRESH", "KEPT"):
            self.addCleanup(setattr, figures.record, name, getattr(figures.record, name))
            setattr(figures.record, name, pathlib.Path(folder.name) / name)

    def take(self, *names):
        with contextlib.redirect_stdout(io.StringIO()):
            figures.take(names)
        return {name: kept["options"] for name, kept in figures.records().items()}

    def test_whole_runs_are_taken_and_quick_ones_by_name(self):
        figures.record.write({**MEASURED, "benchmark": "governor"})
        figures.record.write({**MEASURED, "benchmark": "edid", "options": ["--quick"]})
        self.assertEqual(self.take(), {"governor": []})
        self.assertEqual(self.take("edid.quick"), {"governor": [], "edid": ["--quick"]})

    def test_failed_unknown_and_missing_records_are_refused(self):
        figures.record.write({**MEASURED, "benchmark": "governor", "status": 3})
        for name, sentence in (("governor", "ended with 3"), ("other", "no benchmark 'other'"), ("edid", "no record edid")):
            with self.subTest(name), self.assertRaisesRegex(figures.FiguresError, sentence):
                self.take(name)


class Code(unittest.TestCase):
    def files(self, name):
        return figures.measured_code.files_of(figures.run.read_table()[name])

    def test_code_is_what_targets_include_with_the_sources_of_headers(self):
        files = self.files("tag-pose")
        for name in ("tests/bench/tracker/pose.cpp", "appliance/tags/tag_detector.h", "appliance/tags/tag_detector.cpp"):
            self.assertIn(name, files)
        self.assertNotIn("renderfarm/render/camera.cpp", files)

    def test_every_benchmark_measures_some_code(self):
        for name in figures.run.read_table():
            with self.subTest(name):
                self.assertTrue(self.files(name))

    def test_comments_make_no_figure_old(self):
        code = figures.measured_code
        with tempfile.TemporaryDirectory(dir=ROOT / "tests/bench") as folder:
            for name, text in (("a.cpp", "int a;  // One.\n"), ("b.cpp", "int   a;\n"), ("c.cpp", "int b;\n")):
                (pathlib.Path(folder) / name).write_text(text)
            codes = [code.code_of(f"{pathlib.Path(folder).relative_to(ROOT)}/{name}") for name in ("a.cpp", "b.cpp", "c.cpp")]
        self.assertEqual(codes[0], codes[1])
        self.assertNotEqual(codes[0], codes[2])

    def test_a_record_of_other_code_is_older(self):
        entry = figures.run.read_table()["governor"]
        self.assertEqual(figures.state_of("governor", entry, {"code": figures.measured_code.digest_of(entry)}), "as the code")
        self.assertEqual(figures.state_of("governor", entry, {"code": "other"}), "older")
        self.assertEqual(figures.state_of("governor", entry, None), "none")


class Night(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        root = pathlib.Path(folder.name)
        for module, name, value in ((nightly, "FOLDER", root / "nightly"), (nightly.record, "FRESH", root / "fresh"),
                                    (nightly.record, "KEPT", root / "kept")):
            self.addCleanup(setattr, module, name, getattr(module, name))
            setattr(module, name, value)

    def test_the_page_tells_what_fell_what_holds_and_what_waits(self):
        nightly.record.write(MEASURED)
        nightly.record.keep({**MEASURED, "result": {"a": {"b": 1}}, "goals": {}})
        nightly.record.write({**MEASURED, "benchmark": "good", "goals": {"a.b <= 3": True}})
        done = {"status": 0, "seconds": 7}
        state = {"commit": "c", "done": {"one": done, "good": done, "broken": {"status": 1, "seconds": 1},
                                         "absent": {"status": 77, "seconds": 0}}}
        self.assertEqual(nightly.write_page(state, ["one", "good", "broken", "absent", "later"], False), (2, 1))
        page = (nightly.FOLDER / "page.md").read_text()
        self.assertIn("**missed: a.b <= 1**; changed: a.b 1 → 2", page)
        self.assertIn("`broken`: ended with 1", page)
        self.assertIn("`absent`: its data or devices are not here", page)
        self.assertIn("## Not done yet: 1\n\n`later`", page)

    def test_a_state_of_another_commit_is_forgotten(self):
        nightly.write_state({"commit": "c", "done": {"one": {"status": 0, "seconds": 1}}})
        self.assertEqual(list(nightly.read_state("c", False)["done"]), ["one"])
        self.assertEqual(nightly.read_state("d", False)["done"], {})
        self.assertEqual(nightly.read_state("c", True)["done"], {})

    def test_a_benchmark_that_hangs_is_ended_with_all_its_processes(self):
        root = nightly.FOLDER.parent
        (root / "bench.sh").write_text("#!/bin/sh\nsleep 60 & wait\n")
        (root / "bench.sh").chmod(0o755)
        self.addCleanup(setattr, nightly, "ROOT", nightly.ROOT)
        nightly.ROOT = root
        self.assertEqual(nightly.measure("x", [], 0.2), 124)


if __name__ == "__main__":
    unittest.main()
