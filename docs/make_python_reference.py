#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Writes the reference of the package from its docstrings, signatures and stub: docs/python_reference.md.

PYTHONPATH=build/python python3 docs/make_python_reference.py > docs/python_reference.md
"""
import ast
import inspect
import pathlib
import re

import holdfast

STUB = ast.parse((pathlib.Path(holdfast.__file__).parent / "_core.pyi").read_text(encoding="utf-8"))
CORE = {node.name: node for node in STUB.body if isinstance(node, (ast.ClassDef, ast.FunctionDef))}


def signature(node: ast.FunctionDef, skip_self: bool) -> str:
    """The parameters of a function of the stub and its result."""
    arguments = ast.unparse(node.args)
    if skip_self:
        arguments = re.sub(r"^self(, )?", "", arguments)
    result = f" -> {ast.unparse(node.returns)}" if node.returns and ast.unparse(node.returns) != "None" else ""
    return short(f"({arguments}){result}")


def short(text: str) -> str:
    """Types as users write them."""
    for long, name in (
        (r"(numpy\.typing|npt)\.NDArray\[(np|numpy)\.(\w+)\]", r"ndarray[\3]"),
        (r"Union\[str, '?os\.PathLike\[str\]'?\]", "path"),
        (r"holdfast\.\w+\.(?=[A-Z])|typing\.|npt\.|\b_core\.", ""),
        (r"""['"]([\w\[\], .']*\])['"]""", r"\1"),
        (r"(?<!= )'(\w+)'", r"\1"),
    ):
        text = re.sub(long, name, text)
    return text


def documented(thing: object) -> str:
    text = inspect.cleandoc(getattr(thing, "__doc__", None) or "")
    return re.sub(
        r"::\n\n((?:    .*\n|\n)+)", lambda block: f":\n\n```python\n{inspect.cleandoc(block[1])}\n```\n", text + "\n"
    ).strip()


def python_signature(function: object) -> str:
    text = str(inspect.signature(function))  # type: ignore[arg-type]
    return short(re.sub(r"^\(self(, )?", "(", text).replace(" -> None", ""))


def of_core(name: str, node: ast.ClassDef) -> "list[str]":
    lines = [documented(getattr(holdfast, name)).split("\n\nMembers")[0], ""]
    for part in node.body:
        if isinstance(part, ast.FunctionDef) and part.name == "__init__":
            lines.append(f"- `{name}{signature(part, True)}`")
        elif isinstance(part, ast.FunctionDef) and not part.name.startswith("__"):
            if any(ast.unparse(each) == "property" for each in part.decorator_list):
                lines.append(f"- `{part.name}`: `{short(ast.unparse(part.returns))}`")
            else:
                lines.append(f"- `{part.name}{signature(part, True)}`")
        elif isinstance(part, ast.AnnAssign):
            lines.append(f"- `{ast.unparse(part.target)}`: `{short(ast.unparse(part.annotation))}`")
    return lines


def of_class(thing: type) -> "list[str]":
    lines = [documented(thing), ""]
    for name, member in vars(thing).items():
        if name.startswith("_") and name != "__iter__":
            continue
        if isinstance(member, (classmethod, staticmethod)):
            member = member.__func__
        if isinstance(member, property):
            lines.append(f"- `{name}`: {' '.join(documented(member).split())}")
        elif inspect.isfunction(member):
            lines.append(f"- `{name}{python_signature(member)}`: {' '.join(documented(member).split())}")
    for comment, name, kind in re.findall(r"#: (.*)\n\s+self\.(\w+)(?:: ([^=]+))? =", inspect.getsource(thing)):
        lines.append(f"- `{name}`: {comment}")
    return lines


def entry(name: str) -> "list[str]":
    thing = getattr(holdfast, name)
    if name in CORE and getattr(thing, "__module__", "").endswith("_core"):
        node = CORE[name]
        if isinstance(node, ast.ClassDef):
            return [f"### {name}", "", *of_core(name, node)]
        return [f"### {name}", "", f"`{name}{signature(node, False)}`", "", documented(thing).split("\n\n", 1)[-1]]
    if inspect.isclass(thing):
        return [f"### {name}", "", *of_class(thing)]
    return [f"### {name}", "", f"`{name}{python_signature(thing)}`", "", documented(thing)]


def main() -> None:
    names = [name for name in holdfast.__all__ if name != "__version__"]
    functions = [name for name in names if not inspect.isclass(getattr(holdfast, name))]
    errors = [
        name
        for name in names
        if inspect.isclass(getattr(holdfast, name)) and issubclass(getattr(holdfast, name), Exception)
    ]
    classes = [name for name in names if name not in functions and name not in errors]
    lines = [
        "# Reference of the Python package",
        "",
        "Generated from the docstrings by `docs/make_python_reference.py`; a test compares it. The use:"
        " [python.md](python.md).",
        "",
        documented(holdfast).split("\n\n")[-1].replace("\n", " "),
    ]
    for heading, group in (("Functions", functions), ("Classes", classes), ("Errors", errors)):
        lines += ["", f"## {heading}"]
        for name in sorted(group, key=str.lower):
            lines += ["", *entry(name)]
    text = re.sub(r"\n{3,}", "\n\n", "\n".join(lines)).rstrip() + "\n"
    print(text, end="")


if __name__ == "__main__":
    main()
