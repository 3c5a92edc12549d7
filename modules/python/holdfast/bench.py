# SPDX-License-Identifier: BSD-3-Clause
"""Results of `holdfast bench` as records."""

from __future__ import annotations

import csv
import importlib
import os
from pathlib import Path
from typing import Any, Dict, List, Union

from ._errors import InputError

Record = Dict[str, Union[str, int, float, bool, None]]

_TABLES = ("runs", "cells", "improvements", "comparisons", "published", "cost")


def _value(text: str) -> Union[str, int, float, bool, None]:
    if text == "":
        return None
    if text in ("true", "false"):
        return text == "true"
    try:
        return int(text) if text.lstrip("-").isdigit() else float(text)
    except ValueError:
        return text


class BenchResults:
    """The tables of a benchmark's folder; each is a list of records (dicts) with the columns of its CSV file.

    Numbers are numbers, an empty cell is None.
    """

    def __init__(self, folder: Union[str, "os.PathLike[str]"]) -> None:
        tables = Path(folder) / "tables"
        self.folder = tables if tables.is_dir() else Path(folder)
        if not any((self.folder / f"{name}.csv").is_file() for name in _TABLES):
            raise InputError(
                f"{self.folder}: holds no results; expected the output folder of `holdfast bench`, or its folder tables"
            )

    def table(self, name: str) -> List[Record]:
        """A table by the name of its file: runs, cells, improvements, comparisons, published or cost.

        Raises InputError for one that the folder does not have.
        """
        file = self.folder / f"{name}.csv"
        if not file.is_file():
            there = ", ".join(each for each in _TABLES if (self.folder / f"{each}.csv").is_file())
            raise InputError(f"{file}: is missing; the folder holds {there}")
        with open(file, newline="", encoding="utf-8") as stream:
            return [{key: _value(text) for key, text in row.items()} for row in csv.DictReader(stream)]

    @property
    def runs(self) -> List[Record]:
        """One record per run: variant, sequence, how it ended, poses and errors."""
        return self.table("runs")

    @property
    def cells(self) -> List[Record]:
        """One record per variant and sequence: coverage, and median, least and most of each error."""
        return self.table("cells")

    @property
    def comparisons(self) -> List[Record]:
        """One record per pair of variants and error: gains over all sequences and their significance."""
        return self.table("comparisons")

    def frame(self, name: str = "cells") -> Any:
        """A table as pandas.DataFrame. Raises ImportError without pandas."""
        try:
            pandas = importlib.import_module("pandas")
        except ImportError as error:
            raise ImportError(
                "data frames need pandas, which is not installed; install python3-pandas (Debian) or "
                "pandas (pip), or use table()"
            ) from error
        return pandas.DataFrame.from_records(self.table(name))

    def __repr__(self) -> str:
        return f"BenchResults({str(self.folder)!r}, {len(self.runs)} runs)"

    def _repr_html_(self) -> str:
        from ._notebook import table

        rows = self.cells
        header = list(rows[0]) if rows else []
        return table(header, [[_text(row[name]) for name in header] for row in rows])


def _text(value: Any) -> str:
    return "" if value is None else f"{value:.4g}" if isinstance(value, float) else str(value)


def read_bench(folder: Union[str, "os.PathLike[str]"]) -> BenchResults:
    """The results that `holdfast bench` wrote into a folder. Raises InputError for a folder without its tables."""
    return BenchResults(folder)
