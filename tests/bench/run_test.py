#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Checks the table of benchmarks and the program that runs it. Run: run_test.py"""
import contextlib
import io
import os
import pathlib
import re
import shlex
import subprocess
import sys
import tempfile
import unittest

sys.dont_write_bytecode = True
sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent))
import run  # noqa: E402

ROOT = pathlib.Path(__file__).resolve().parents[2]
TARGET = re.compile(r"(?:add_executable\(|project_(?:program|bench)\(\s*NAME\s+)([\w.-]+)")
PROGRAM = re.compile(r"\{(?:bin|tests)\}/([\w.-]+)")


def targets_of_the_tree():
    lists = [*ROOT.glob("CMakeLists.txt"), *(file for top in ("common", "drivers", "renderfarm", "appliance", "kiosk", "tests")
                                             for file in (ROOT / top).rglob("CMakeLists.txt"))]
    return {name for file in lists for name in TARGET.findall(file.read_text(encoding="utf-8"))}


def bench(*words, **environment):
    return subprocess.run([ROOT / "bench.sh", *words], capture_output=True, text=True, check=False, env={**os.environ, **environment})


class Table(unittest.TestCase):
    def setUp(self):
        self.table = run.read_table()

    def test_an_entry_has_known_keys_and_kinds_of_packages(self):
        for name, entry in self.table.items():
            with self.subTest(name):
                self.assertLessEqual(set(entry), run.KEYS)
                self.assertLessEqual(set(entry.get("packages", [])), run.PACKAGES)
                self.assertTrue(entry["about"] and entry["commands"])

    def test_targets_are_in_the_tree(self):
        known = targets_of_the_tree()
        for name, entry in self.table.items():
            with self.subTest(name):
                self.assertLessEqual(set(entry.get("targets", [])), known)

    def test_programs_of_the_commands_are_built(self):
        for name, entry in self.table.items():
            with self.subTest(name):
                self.assertLessEqual(set(PROGRAM.findall(" ".join(entry["commands"]))), set(entry.get("targets", [])))

    def test_a_program_of_the_tests_has_their_packages(self):
        for name, entry in self.table.items():
            if "{tests}/" in " ".join(entry["commands"]):
                with self.subTest(name):
                    self.assertIn("test", entry["packages"])

    def test_files_of_the_commands_exist_and_braces_are_known(self):
        for name, entry in self.table.items():
            with self.subTest(name):
                kinds = run.generated.FOLDERS
                self.assertLessEqual(set(entry.get("scenes", {})), set(kinds))
                values = (run.places("BUILD") | {kind: "SCENE" for kind in entry.get("scenes", {})} | entry.get("values", {})
                          | {"json": "J", "figures": "F", "temporary": "T"})
                for command in entry["commands"]:
                    words = run.command_words(command, values, {"quick": [], "options": []})
                    for word in words:
                        if word.startswith(("tests/", "scripts/")):
                            self.assertTrue((ROOT / word).is_file(), word)

    def test_quick_values_override_values_and_make_a_difference(self):
        for name, entry in self.table.items():
            with self.subTest(name):
                self.assertLessEqual(set(entry.get("quick", {})), set(entry.get("values", {})))
                is_quicker = "quick" in entry or "{quick}" in " ".join(entry["commands"])
                self.assertEqual("quicker" in entry, is_quicker)

    def test_an_option_is_a_value_or_is_passed_on(self):
        for name, entry in self.table.items():
            for form in entry.get("options", {}):
                with self.subTest(f"{name} {form}"):
                    option = form.split()[0]
                    self.assertTrue(option[2:] in entry.get("values", {}) or "{options}" in " ".join(entry["commands"]))


class Words(unittest.TestCase):
    ENTRY = {"about": "", "commands": [], "values": {"seed": 1}, "options": {"--seed S": "", "--only NAME": "", "--keep": ""}}

    def test_options_set_values_or_are_passed_on(self):
        self.assertEqual(run.parse("x", self.ENTRY, ["--quick", "--seed", "7", "--only=a b", "--keep"]),
                         (True, {"seed": "7"}, ["--only", "a b", "--keep"]))

    def test_wrong_options_are_refused(self):
        for words in (["--other"], ["word"], ["--seed"], ["--quick=1"]):
            with self.subTest(words), self.assertRaises(run.UsageError):
                run.parse("x", self.ENTRY, words)

    def test_lists_become_words_and_values_stay_one(self):
        self.assertEqual(run.command_words("a {quick} {options} b={seed}", {"seed": "1 2"}, {"quick": [], "options": ["-x", "y z"]}),
                         ["a", "-x", "y z", "b=1 2"])


class Measure(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.records = pathlib.Path(folder.name)
        self.addCleanup(setattr, run.record, "FRESH", run.record.FRESH)
        run.record.FRESH = self.records

    def measure(self, entry, *words):
        os.environ["CYCLORAMA_BUILD"] = "BUILD"
        out = io.StringIO()
        with contextlib.redirect_stdout(out):
            status = run.measure("example", {"about": "", **entry}, words)
        return status, out.getvalue()

    def python(self, text):
        return f"{shlex.quote(sys.executable)} -c {shlex.quote(text)}"

    def test_what_is_written_to_json_becomes_the_last_line(self):
        write = "import sys; open(sys.argv[1], 'w').write('{\"a\": ' + sys.argv[2] + '}')"
        entry = {"values": {"a": 1}, "quick": {"a": 2}, "commands": [self.python(write).replace("{", "{{").replace("}", "}}") + " {json} {a}"]}
        self.assertEqual(self.measure(entry), (0, '{"benchmark": "example", "a": 1}\n'))
        self.assertEqual(self.measure(entry, "--quick"), (0, '{"benchmark": "example", "a": 2}\n'))

    def test_a_run_leaves_a_record_with_machine_date_commit_and_goals(self):
        entry = {"goals": ["a <= 3", "b >= 1", "c == 0"],
                 "commands": [self.python('print("a table"); print(chr(123) + chr(34) + "a" + chr(34) + ": 2" + chr(125))')
                              .replace("{", "{{").replace("}", "}}"), self.python("print('more')")]}
        self.measure(entry)
        kept = run.record.read(self.records / "example.json")
        self.assertEqual((kept["status"], kept["result"], kept["printed"]), (0, {"a": 2}, "a table"))
        self.assertEqual(kept["goals"], {"a <= 3": True, "b >= 1": None, "c == 0": None})
        self.assertRegex(kept["date"], r"^20\d\d-\d\d-\d\d ")
        self.assertTrue(kept["machine"]["cores"] >= 1 and kept["machine"]["processor"])

    def test_a_run_that_goes_on_later_or_lacks_data_leaves_no_record(self):
        for status in (run.UNFINISHED, run.SKIPPED):
            self.measure({"commands": [self.python(f"raise SystemExit({status})")]})
        self.assertEqual(list(self.records.iterdir()), [])

    def test_a_failure_is_in_the_record(self):
        self.measure({"commands": [self.python("raise SystemExit(3)")]})
        self.assertEqual(run.record.read(self.records / "example.json")["status"], 3)

    def test_the_first_failure_ends_it(self):
        with tempfile.TemporaryDirectory() as folder:
            never = pathlib.Path(folder) / "never"
            self.assertEqual(self.measure({"commands": [self.python("raise SystemExit(75)"), f"touch {never}"]})[0], 75)
            self.assertFalse(never.exists())

    def test_a_command_can_write_to_a_file(self):
        with tempfile.TemporaryDirectory() as folder:
            file = pathlib.Path(folder) / "made/out.csv"
            self.assertEqual(self.measure({"commands": [f"echo {{build}} > {file}"]}), (0, ""))
            self.assertEqual(file.read_text(), "BUILD\n")

    def test_missing_data_skip(self):
        with contextlib.redirect_stderr(io.StringIO()) as printed:
            self.assertEqual(self.measure({"needs": "/nowhere/data", "commands": ["false"]})[0], run.SKIPPED)
        self.assertEqual(printed.getvalue(), "bench.sh: example needs the data in /nowhere/data, which are not there\n")


class Goals(unittest.TestCase):
    def test_dots_lead_into_objects_and_a_star_to_each(self):
        result = {"rooms": {"a": {"p95": 1.0}, "b": {"p95": 2.0}}, "n": 0}
        self.assertTrue(run.goals.is_held("rooms.*.p95 <= 2", result))
        self.assertFalse(run.goals.is_held("rooms.*.p95 <= 1.5", result))
        self.assertTrue(run.goals.is_held("n == 0", result))
        self.assertIsNone(run.goals.is_held("rooms.c.p95 <= 1", result))

    def test_goals_of_the_table_are_goals(self):
        for name, entry in run.read_table().items():
            for goal in entry.get("goals", []):
                with self.subTest(name):
                    run.goals.parse(goal)
        with self.assertRaises(ValueError):
            run.goals.parse("p95 < 3")


class CommandLine(unittest.TestCase):
    def test_list_has_every_name(self):
        listed = bench("--list")
        self.assertEqual([line.split()[0] for line in listed.stdout.splitlines()], sorted(run.read_table()))

    def test_an_unknown_name_is_one_sentence(self):
        done = bench("nothing", "--quick")
        self.assertEqual((done.returncode, done.stdout, done.stderr), (2, "", "bench.sh: no benchmark 'nothing'; see ./bench.sh --list\n"))

    def test_an_unknown_option_is_one_sentence(self):
        done = bench("tag-pose", "--fast")
        self.assertEqual((done.returncode, done.stderr.count("\n")), (2, 1))
        self.assertIn("tag-pose has no option '--fast'", done.stderr)

    def test_help(self):
        for words in ([], ["-h"], ["--help"]):
            self.assertIn("./bench.sh --list", bench(*words).stdout)
        self.assertIn("--records FILE", bench("calibration-solve", "--help").stdout)


if __name__ == "__main__":
    unittest.main()
