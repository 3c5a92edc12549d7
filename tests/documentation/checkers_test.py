#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""The checkers of the pages find what they should: on made-up pages, with mistakes and without."""
import pathlib
import sys
import tempfile
import unittest

import check_links
import check_settings
import markdown
import shell

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[2] / "docs"))
import renew_figures


class Links(unittest.TestCase):
    def problems(self, **pages: str) -> list[str]:
        with tempfile.TemporaryDirectory() as folder:
            root = pathlib.Path(folder)
            (root / "docs").mkdir()
            for name, text in pages.items():
                (root / "docs" / f"{name}.md").write_text(text)
            return check_links.problems_of(root)[0]

    def test_good_links(self):
        other = "# A `b`: c, d\n\n## Twice\n\n## Twice\n"
        page = ("[x](b.md) [y](b.md#a-b-c-d) [z](b.md#twice-1) ![p](../docs/b.md) [w](https://a.b/c) [h](#here)\n\n"
                "# Here\n")
        self.assertEqual(self.problems(a=page, b=other), [])

    def test_bad_links(self):
        for link in ("[x](c.md)", "[x](b.md#none)", "[x](#none)", "![x](none.png)", "[x](../../a)", "[x](/docs/b.md)",
                     "[x]: c.md", '<img src="none.png">', "- one\n    - [x](c.md)"):
            with self.subTest(link):
                self.assertEqual(len(self.problems(a=link, b="# B\n")), 1)

    def test_built_folders_hold_no_pages(self):
        with tempfile.TemporaryDirectory() as folder:
            root = pathlib.Path(folder)
            for name in ("docs", "build", "out", ".git", "elsewhere"):
                (root / name).mkdir()
                (root / name / "a.md").write_text("")
            (root / "elsewhere/CMakeCache.txt").write_text("")
            self.assertEqual(markdown.pages(root), [root / "docs/a.md"])

    def test_code_holds_no_links(self):
        self.assertEqual(self.problems(a="```cpp\n[x](c.md)\n```\nand `[x](c.md)`\n"), [])


class Blocks(unittest.TestCase):
    def test_lines_and_languages(self):
        text = "a\n\n```sh\none\n\ntwo\n```\n```\nthree\n```\n"
        self.assertEqual(markdown.blocks(text),
                         [markdown.Block("sh", "one\n\ntwo\n", 4), markdown.Block("", "three\n", 9)])

    def test_no_heading_in_a_block(self):
        self.assertEqual(markdown.headings("# A\n```sh\n# B\n```\n"), ["A"])

    def test_a_block_must_end(self):
        with self.assertRaises(ValueError):
            markdown.blocks("```sh\none\n")


class Commands(unittest.TestCase):
    def texts(self, lines: str) -> list[str]:
        return [command.text for command in shell.commands_of("page", f"```sh\n{lines}\n```\n")]

    def test_one_by_one(self):
        self.assertEqual(self.texts("a b   # why\n# alone\n\nc --d '#e'"), ["a b", "c --d '#e'"])
        self.assertEqual(self.texts("a \\\n  b\nc"), ["a \\\n  b", "c"])
        self.assertEqual(self.texts("for x in 1 2; do\n  a $x\ndone\nb"), ["for x in 1 2; do\n  a $x\ndone", "b"])

    def test_a_command_must_end(self):
        with self.assertRaises(ValueError):
            self.texts("a \\")

    def test_rules(self):
        with tempfile.NamedTemporaryFile("w", suffix=".toml") as file:
            file.write('[[rule]]\ncommand = "a (b)"\nreason = "x"\n'
                       '[[rule]]\nmatches = "/data/"\nreason = "y"\nrun = "c"\n')
            file.flush()
            rules = shell.read_rules(pathlib.Path(file.name))
        find = lambda text: shell.rule_of(shell.Command("page", 1, text), rules)
        self.assertIsNone(find("a (b) c"))
        self.assertIs(find("a (b)"), rules[0])
        self.assertEqual(find("x /data/y").run, "c")
        self.assertTrue(all(rule.used for rule in rules))

    def test_a_rule_needs_a_reason(self):
        with tempfile.NamedTemporaryFile("w", suffix=".toml") as file:
            file.write('[[rule]]\ncommand = "a"\n')
            file.flush()
            with self.assertRaises(ValueError):
                shell.read_rules(pathlib.Path(file.name))


class Figures(unittest.TestCase):
    VALUES = {"a": {"ate": 0.12345, "coverage": 97.5}, "b": {"ate": 0.5}}

    def renewed(self, page: str, text: str) -> tuple[str, list[str]]:
        return renew_figures.renewed(page, renew_figures.Figure("page.md", text), self.VALUES)

    def test_the_same_figure(self):
        page = "An error of 0.1235 m\nwith 98 % of the frames.\n"
        text = "error of <a.ate:.4f> m with <a.coverage:.0f> % of"
        self.assertEqual(self.renewed(page, text), (page, []))

    def test_another_figure_is_named_and_replaced(self):
        page = "# A\n\n| x | `y` | 0.2 | 0.5000 |\n"
        after, changes = self.renewed(page, "| x | ... | <a.ate:.4f> | <b.ate:.1f> |")
        self.assertEqual(after, "# A\n\n| x | `y` | 0.1235 | 0.5 |\n")
        self.assertEqual(changes, ["page.md:3: a.ate is 0.2, measured 0.1235", "page.md:3: b.ate is 0.5000, measured 0.5"])

    def test_a_text_stands_once_in_its_page(self):
        for page in ("", "x 1\nx 1\n"):
            with self.assertRaises(renew_figures.PageError):
                self.renewed(page, "x <a.ate:.0f>")

    def test_quotations(self):
        quotation = renew_figures.Quotation("page.md", "a", "report.md", "`x` against `y`: ")
        quote = lambda page, source: renew_figures.requoted(page, quotation, source)
        page = "Text:\n\n> `x` against `y`: smaller\n> by 0.1.\n>\n> More.\n"
        self.assertEqual(quote(page, "`x` against `y`: smaller by 0.1.\n\nMore.\n"), (page, []))
        after, changes = quote(page, "`x` against `y`: larger by 0.2.\n\nMore.\n")
        self.assertEqual(after, "Text:\n\n> `x` against `y`: larger by 0.2.\n>\n> More.\n")
        self.assertEqual(len(changes), 1)
        item = "- `x` against `z`: no.\n- `x` against `y`: smaller by 0.1.\n- More.\n"
        self.assertEqual(quote(page, item), (page, []))
        table = renew_figures.Quotation("page.md", "a", "report.md", "| a |", after="## B")
        source = "| a |\n|--|\n| 3 |\n\n## B\n\n| a |\n|--|\n| 2 |\n"
        self.assertEqual(renew_figures.requoted("| a |\n|--|\n| 1 |\n\nx\n", table, source)[0],
                         "| a |\n|--|\n| 2 |\n\nx\n")

    def test_lists_stand_for_their_elements(self):
        entries = renew_figures.expanded([{"name": "s_{each}", "each": ["a", "b"]}, {"name": "c"}])
        self.assertEqual([entry["name"] for entry in entries], ["s_a", "s_b", "c"])

    def test_a_figure_needs_its_run(self):
        with tempfile.NamedTemporaryFile("w", suffix=".toml") as file:
            file.write('[[figure]]\npage = "README.md"\ntext = "<none.ate:.4f>"\n')
            file.flush()
            with self.assertRaises(renew_figures.PageError):
                renew_figures.read_list(pathlib.Path(file.name))


class Settings(unittest.TestCase):
    PARAMETER = {"name": "limit", "help": "longest time; 0 = none", "unit": "s", "default": 2.0, "minimum": 0.0,
                 "maximum": 9.0, "required": False}

    def problems(self, declaration: str, **changes) -> list[str]:
        parameter = {**self.PARAMETER, **changes}
        with tempfile.TemporaryDirectory() as folder:
            root = pathlib.Path(folder)
            for top in ("include", "modules", "plugins"):
                (root / top).mkdir()
            (root / "include/a.hpp").write_text("struct ASettings {\n  int other;\n" + declaration + "\n};\n")
            (root / "modules/a.cpp").write_text('using S = ASettings;\ntable\n.add("limit", &S::limit, "'
                                                + parameter["help"].replace("; ", '; "\n"') + '")\n.range(0, 9);')
            problems, count = check_settings.problems_of(root, [{"parameters": [parameter]}])
            self.assertEqual(count, 1)
            return problems

    def test_texts_that_agree(self):
        for declaration in ("  double limit = 2.0;", "  double limit = 2.0;  ///< time [s]; 0 = off",
                            "  /// From 0 to 1: much. 0 = off; 2 as in ORB-SLAM2\n  double other = 1.0, limit = 2.0;",
                            "  double limit =\n      2.0;  ///< time of a x^2 [m] or more,\n  ///< 0 = off"):
            with self.subTest(declaration):
                self.assertEqual(self.problems(declaration), [])

    def test_texts_that_contradict(self):
        for comment in ("0 = off [ms]", "longest time", "0 = off; 5 = all", "0 = off; 3 as in ORB-SLAM2",
                        "0 = off; default: 2", "0 = off; required"):
            with self.subTest(comment):
                self.assertEqual(len(self.problems(f"  double limit = 2.0;  ///< {comment}")), 1)
        self.assertEqual(len(self.problems("  double limit = 2.0;", minimum=1.0)), 1)


if __name__ == "__main__":
    unittest.main()
