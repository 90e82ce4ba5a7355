# SPDX-License-Identifier: GPL-3.0-or-later
"""One finished figure and its files."""

import json
from dataclasses import dataclass
from pathlib import Path

import matplotlib.figure
import matplotlib.pyplot as plt

Row = dict[str, str | int | float | None]
"""Numbers of one curve, picture or bar by name; None where there is none."""


@dataclass
class Figure:
    number: str
    """as in the rough refraction paper"""
    title: str
    caption: str
    """In our own words: what is seen, how it was made, whose models these are."""
    picture: matplotlib.figure.Figure
    rows: list[Row]

    def save(self, folder: Path, command: str) -> Path:
        """Writes figure_NN.png and figure_NN.json into the folder, and returns the latter's path. command:
        what makes the figure again."""
        record = folder / f"figure_{self.number.zfill(2)}.json"
        self.picture.savefig(record.with_suffix(".png"))
        plt.close(self.picture)
        content = {"figure": self.number, "title": self.title, "caption": self.caption, "command": command,
                   "picture": record.with_suffix(".png").name, "numbers": self.rows}
        record.write_text(json.dumps(content, indent=2, allow_nan=False) + "\n", encoding="utf-8")
        return record
