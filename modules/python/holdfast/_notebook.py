# SPDX-License-Identifier: BSD-3-Clause
"""HTML for notebooks."""

from __future__ import annotations

import html
from typing import Any, Dict, List, Sequence


def escaped(text: str) -> str:
    """Text that shows as it is written."""
    return html.escape(text)


def preformatted(text: str) -> str:
    """Text in a fixed-width font."""
    return f"<pre>{html.escape(text)}</pre>"


def figure_row(figures: Sequence[str]) -> str:
    """SVGs beside each other."""
    cells = "".join(f'<div style="flex: 1; min-width: 20em; max-width: 40em">{svg}</div>' for svg in figures)
    return f'<div style="display: flex; flex-wrap: wrap; gap: 1em">{cells}</div>' if cells else ""


def table(header: Sequence[str], rows: Sequence[Sequence[str]]) -> str:
    """A table of texts, the first column flush left."""
    head = "".join(f"<th>{html.escape(name)}</th>" for name in header)
    body = "".join("<tr>" + "".join(f"<td>{html.escape(cell)}</td>" for cell in row) + "</tr>" for row in rows)
    return f"<table><thead><tr>{head}</tr></thead><tbody>{body}</tbody></table>"


def stage_table(stages: List[Dict[str, Any]]) -> str:
    """Times of the stages of a run."""
    rows = [
        [
            stage["stage"],
            f"{1e3 * stage['median_s']:.2f}",
            f"{1e3 * stage['p95_s']:.2f}",
            f"{100 * stage['share']:.1f}",
        ]
        for stage in stages
    ]
    return table(["stage", "median [ms]", "95 % [ms]", "share [%]"], rows)
