# SPDX-License-Identifier: GPL-3.0-or-later
"""The page that shows all figures of a folder, and what isn't made yet."""

import json
from html import escape
from pathlib import Path

from verglas.compare import pages

from .figure import label

NOT_YET = {
    "Rough refraction, Fig. 16":
        "the slab before a spherical light needs thin panes and local lights.",
    "Thin layers (ENDF), Fig. 10":
        "the rough slab needs thin panes.",
}
"""Figures of the two papers that wait for a feature, and for which."""

TEMPLATE = Path(__file__).with_name("figures.html")


def write(folder: Path) -> Path:
    """Writes figures.json and index.html from the figures' own files, of this run and earlier ones; returns
    the page's path."""
    records = [json.loads(path.read_text(encoding="utf-8")) for path in sorted(folder.glob("figure_*.json"))]
    content = {"figures": {record["figure"]: record for record in records}, "not_yet": NOT_YET}
    (folder / "figures.json").write_text(json.dumps(content, indent=2) + "\n", encoding="utf-8")
    page = folder / "index.html"
    page.write_text(pages.page(str(TEMPLATE), {
        "figures": "".join(_section(record) for record in records),
        "not_yet": pages.items((f"{name}: {reason}" for name, reason in NOT_YET.items()), ""),
    }), encoding="utf-8")
    return page


def _section(record: dict) -> str:
    title = f"{label(record['figure'])}: {record['title']}"
    return pages.section(title, f"""{pages.picture(record['picture'], title)}
<p>{escape(record['caption'])}</p>
<details><summary>Numbers</summary>{_table(record['numbers'])}</details>
<div class="command"><code>{escape(record['command'])}</code><button type="button">Copy</button></div>""")


def _table(rows: list[dict]) -> str:
    names = list(dict.fromkeys(name for row in rows for name in row))
    return pages.table(names, ([_cell(row.get(name)) for name in names] for row in rows))


def _cell(value: str | bool | int | float | None) -> str:
    return pages.cell(pages.number(value, 4) if value is None or isinstance(value, float) else str(value))
