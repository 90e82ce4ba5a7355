# SPDX-License-Identifier: GPL-3.0-or-later
"""One finished figure and its files."""

import json
import re
from dataclasses import dataclass
from pathlib import Path

import matplotlib.figure
import matplotlib.pyplot as plt

PAPERS = {"": "Rough refraction", "endf": "Thin layers (ENDF)"}
"""Titles by the beginning of their figures' ids."""

Row = dict[str, str | int | float | None]
"""Numbers of one curve, picture or bar by name; None where there is none."""


def _parts(figure_id: str) -> tuple[str, str, str]:
    """Beginning of its paper, what it is, and its number there."""
    return re.fullmatch(r"([a-z]*)(_[a-z]+)?(\d+)", figure_id).groups("")


def label(figure_id: str) -> str:
    """How readers of the paper know it."""
    paper, kind, number = _parts(figure_id)
    return f"{PAPERS[paper]}, {kind[1:].capitalize() or 'Fig.'} {number}"


@dataclass
class Figure:
    id: str
    """The number of the rough refraction paper's; endf5 of the ENDF paper's, endf_table2 of its tables."""
    title: str
    caption: str
    """In our own words: what is seen, how it was made, whose models these are."""
    picture: matplotlib.figure.Figure
    rows: list[Row]

    def save(self, folder: Path, command: str) -> Path:
        """Writes its picture and numbers into the folder, figure_03.png and .json or figure_endf05.png and
        .json, and returns the latter's path. command: what makes the figure again."""
        paper, kind, number = _parts(self.id)
        record = folder / f"figure_{paper}{kind}{number.zfill(2)}.json"
        self.picture.savefig(record.with_suffix(".png"))
        plt.close(self.picture)
        content = {"figure": self.id, "title": self.title, "caption": self.caption, "command": command,
                   "picture": record.with_suffix(".png").name, "numbers": self.rows}
        record.write_text(json.dumps(content, indent=2, allow_nan=False) + "\n", encoding="utf-8")
        return record
