# SPDX-License-Identifier: GPL-3.0-or-later
"""Runs a comparison of one case or of many, and writes all of its reports."""

from collections.abc import Callable, Sequence
from pathlib import Path

from .. import verglas_core as core
from ..faults import Fault
from . import overview, report
from .cases import Case, open_case
from .comparison import Options, compare
from .progress import Progress

Command = Callable[[Case | None, Path], str]
"""The line that makes a case's report, or for None all of them, again in a folder."""


def run(cases: Sequence[Case], options: Options, folder: Path, command: Command, progress: Progress) -> bool:
    """A single case has its report in the folder itself; several have theirs in folders inside, under the
    cases' names, and an overview. Returns whether there is a report of each."""
    if len(cases) == 1:
        try:
            _run_case(cases[0], options, folder, command, progress)
        except (Fault, core.Error) as fault:
            progress.say(str(fault))
            return False
        progress.say(f"wrote {folder / 'index.html'}")
        return True

    reports: dict[str, dict] = {}
    faults: dict[str, str] = {}
    for i, case in enumerate(cases):
        progress.subject(f"{i + 1}/{len(cases)} {case.name}")
        try:
            reports[case.name] = _run_case(case, options, folder / case.name, command, progress,
                                           overview_path="../index.html")
        except (Fault, core.Error) as fault:
            faults[case.name] = str(fault)
            progress.say(str(fault))
    progress.subject("")
    overview.write(reports, faults, command(None, folder), folder)
    progress.say(f"wrote {folder / 'index.html'}")
    return not faults


def _run_case(case: Case, options: Options, folder: Path, command: Command, progress: Progress,
              overview_path: str = "") -> dict:
    """Returns what report.json holds."""
    for name in ("report.json", "index.html", "summary.json"):  # of an earlier run
        (folder / name).unlink(missing_ok=True)
    comparison = compare(open_case(case), options, progress)
    progress.step("writing the report")
    return report.write(comparison, case, command(case, folder), folder, overview_path)
