# SPDX-License-Identifier: GPL-3.0-or-later
"""Pieces of HTML that the pages of a report share. All text that goes in is escaped here."""

import string
from collections.abc import Iterable, Mapping, Sequence
from html import escape
from pathlib import Path
from urllib.parse import quote

FOLDER = Path(__file__).parent / "html"


def page(template: str, values: Mapping[str, str]) -> str:
    """One of the templates beside the style sheet, which goes into the page as the script does: a report
    is a folder of its own. values: HTML."""
    text = (FOLDER / template).read_text(encoding="utf-8")
    shared = {"style": (FOLDER / "style.css").read_text(encoding="utf-8"),
              "script": (FOLDER / "script.js").read_text(encoding="utf-8")}
    return string.Template(text).substitute(shared | dict(values))


def facts(pairs: Mapping[str, str]) -> str:
    """The inside of a definition list."""
    return "".join(f"<div><dt>{escape(term)}</dt><dd>{escape(text)}</dd></div>"
                   for term, text in pairs.items())


def table(heads: Sequence[str], rows: Iterable[Sequence[str]], css_class: str = "") -> str:
    """rows: whole cells in HTML, as cell() and head() make them."""
    first = "".join(f"<th>{escape(text)}</th>" for text in heads)
    body = "".join(f"<tr>{''.join(row)}</tr>\n" for row in rows)
    return f'<table class="{css_class}"><thead><tr>{first}</tr></thead>\n<tbody>\n{body}</tbody></table>'


def head(text: str) -> str:
    """The first cell of a row."""
    return f"<th>{escape(text)}</th>"


def cell(text: str, best: bool = False, part: float | None = None) -> str:
    """best: marked as such. part: 0 … 1, length of a bar under the text."""
    classes = " ".join(name for name, on in (("best", best), ("bar", part is not None)) if on)
    style = f' style="--part: {part:.1%}"' if part is not None else ""
    return f'<td class="{classes}"{style}>{escape(text)}</td>'


def options(values: Mapping[str, str], chosen: str) -> str:
    """Of a list: texts by value."""
    def option(value: str, text: str) -> str:
        selected = " selected" if value == chosen else ""
        return f'<option value="{escape(value)}"{selected}>{escape(text)}</option>'

    return "".join(option(value, text) for value, text in values.items())


def picture(path: str, text: str) -> str:
    """A picture that opens at full size. path: relative to the page."""
    return f'<a href="{quote(path)}"><img src="{quote(path)}" alt="{escape(text)}" loading="lazy"></a>'


def figure(path: str, caption: str) -> str:
    return f"<figure>{picture(path, caption)}<figcaption>{escape(caption)}</figcaption></figure>"


def items(sentences: Iterable[str], otherwise: str) -> str:
    """A list, or a sentence in its place where it would be empty."""
    entries = "".join(f"<li>{escape(sentence)}</li>\n" for sentence in sentences)
    return f'<ul class="notes">\n{entries}</ul>' if entries else f"<p>{escape(otherwise)}</p>"


def section(title: str, body: str) -> str:
    return f"<section>\n<h2>{escape(title)}</h2>\n{body}\n</section>\n"


def number(value: float | None, digits: int = 3) -> str:
    """Of so many significant digits, as 0.0123, 12.3 or 1.23e-05; a dash for None."""
    return "–" if value is None else f"{value:.{digits}g}"


def seconds(value: float) -> str:
    """As 12.3 ms or 4.56 s."""
    if value < 1.0:
        return f"{number(1000.0 * value)} ms"
    return f"{value:.3g} s" if value < 1000.0 else f"{value:,.0f} s"
