# SPDX-License-Identifier: GPL-3.0-or-later
"""Writes the overview of several cases: summary.json, and index.html with a table of cases and methods."""

import json
import statistics
from html import escape
from pathlib import Path

from ..faults import Fault
from . import pages
from .methods import METHODS, REAL_TIME, SCREEN_SPACE, TRACED
from .report import best_of

JUDGED = "bundle"
"""The method that is compared with the best of the others in screen space."""

SHOWN = (JUDGED, TRACED)
"""The methods whose pictures stand in the table."""


def write(reports: dict[str, dict], faults: dict[str, str], command: str, folder: Path) -> dict:
    """reports: what report.json holds, by name of the case and of its folder; faults: the sentence for each
    case that has none. Returns what summary.json holds."""
    summary = _summary(reports, faults, command)
    try:
        folder.mkdir(parents=True, exist_ok=True)
        (folder / "summary.json").write_text(json.dumps(summary, indent=2) + "\n", encoding="utf-8")
        (folder / "index.html").write_text(_page(summary), encoding="utf-8")
    except OSError as error:
        raise Fault(f"The overview in '{folder}' can't be written: {error.strerror}.") from error
    return summary


def _summary(reports: dict[str, dict], faults: dict[str, str], command: str) -> dict:
    cases = {name: _case(report) for name, report in reports.items()}
    ratios = [case["ratio"] for case in cases.values() if case["ratio"] is not None]
    return {
        "cases": cases,
        "methods": [name for name in METHODS if any(name in case["relmse"] for case in cases.values())],
        "wins": sum(ratio < 1.0 for ratio in ratios),
        "judged": len(ratios),
        "mean_ratio": statistics.fmean(ratios) if ratios else None,
        "faults": faults,
        "command": command,
    }


def _case(report: dict) -> dict:
    real_time = {name: entry for name, entry in report["methods"].items() if name in REAL_TIME}
    others = [entry["relmse"] for name, entry in real_time.items() if name in SCREEN_SPACE and name != JUDGED]
    best_other = min(others, default=0.0)
    ratio = real_time[JUDGED]["relmse"] / best_other if JUDGED in real_time and best_other > 0.0 else None
    return {
        **{key: report[key] for key in ("file", "roughness", "map")},
        "relmse": {name: entry["relmse"] for name, entry in report["methods"].items()},
        "best": best_of("relmse", real_time),
        "ratio": ratio,
        "truth_noise": report["truth"]["noise"],
        "truth_spp": report["truth"]["spp"],
    }


def _page(summary: dict) -> str:
    cases = summary["cases"]
    facts = {}
    if summary["judged"]:
        facts = {
            f"{JUDGED} is the best in screen space": f"in {summary['wins']} of {summary['judged']} cases",
            f"Error of {JUDGED} to the best other there": f"{pages.number(summary['mean_ratio'])} on average",
        }
    faults = [f"{name}: {sentence}" for name, sentence in summary["faults"].items()]
    heads = ["Case", "Truth", *SHOWN, *summary["methods"], "Noise", "Ratio"]
    return pages.page("overview.html", {
        "count": str(len(cases)),
        "facts": pages.facts(facts),
        "table": pages.table(heads, (_row(name, case, summary["methods"]) for name, case in cases.items()),
                             "cases"),
        "faults": pages.section("Cases without a report", pages.items(faults, "")) if faults else "",
        "command": escape(summary["command"]),
    })


def _row(name: str, case: dict, methods: list[str]) -> list[str]:
    def thumbnail(picture: str) -> str:
        return f"<td>{pages.picture(f'{name}/{picture}.png', f'{name}, {picture}')}</td>"

    errors = [pages.cell(pages.number(case["relmse"].get(method)), method == case["best"])
              for method in methods]
    return [
        f'<th><a href="{pages.quote(name)}/index.html">{escape(name)}</a></th>',
        thumbnail("truth"),
        *(thumbnail(method) if method in case["relmse"] else "<td></td>" for method in SHOWN),
        *errors, pages.cell(pages.number(case["truth_noise"], 2)),
        pages.cell("–" if case["ratio"] is None else f"{case['ratio']:.2f}"),
    ]
