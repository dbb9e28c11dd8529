"""Tables as files: HTML for a browser, CSV for a program, LaTeX for a paper."""

from __future__ import annotations

import re
from collections.abc import Iterable
from pathlib import Path

from jinja2 import Environment

from curlshot.data.files import write_text
from curlshot.data.tracks import write_table
from curlshot.report.columns import Column, Table

_HTML = """\
<!DOCTYPE html>
<html lang="en-GB">
<head>
<meta charset="utf-8">
<title>{{ table.title }}</title>
<style>
body { font: 15px/1.5 system-ui, "DejaVu Sans", sans-serif; margin: 2rem; color: #1a1a1a; }
table { border-collapse: collapse; border-block: 2px solid; }
caption { text-align: left; font-weight: 600; padding-bottom: .4rem; }
th, td { padding: .2rem .7rem; text-align: right; vertical-align: top; white-space: nowrap;
  font-variant-numeric: tabular-nums; }
thead th { border-bottom: 1px solid; font-weight: 600; }
.word, .note { text-align: left; } td.note { white-space: normal; }
</style>
</head>
<body>
<table>
<caption>{{ table.title }}</caption>
<thead><tr>{% for column in table.head %}<th scope="col" class="{{ column.kind }}">
{{- column.head }}{% if column.unit %} ({{ column.unit }}){% endif %}</th>{% endfor %}</tr></thead>
<tbody>
{% for row in table.rows %}<tr>{% for cell in row %}<td class="{{ table.head[loop.index0].kind }}">
{{- cell }}</td>{% endfor %}</tr>
{% endfor %}</tbody>
</table>
<p>{{ table.note }}</p>
</body>
</html>
"""

_LATEX = {
    "\\": r"\textbackslash{}", "&": r"\&", "%": r"\%", "$": r"\$", "#": r"\#", "_": r"\_",
    "{": r"\{", "}": r"\}", "~": r"\textasciitilde{}", "^": r"\textasciicircum{}",
    "−": "$-$", "±": r"$\pm$", "×": r"$\times$", "≤": r"$\le$", "≥": r"$\ge$", "—": "---",
    "–": "--", "…": r"\ldots{}", "°": r"$^\circ$", "²": "$^2$", "′": "$'$", "·": r"$\cdot$",
    "μ": r"$\mu$", "ₛ": r"$_{\mathrm{s}}$", "ω": r"$\omega$", "θ": r"$\theta$",
    "Σ": r"$\Sigma$", "Δ": r"$\Delta$",
    "“": "``", "”": "''", "’": "'",
}  # fmt: skip


def write_tables(folder: Path, tables: Iterable[Table]) -> None:
    """Write each table into `folder` as ``NAME.html``, ``NAME.csv`` and ``NAME.tex``."""
    for table in tables:
        write_text(folder / f"{table.name}.html", html_text(table))
        write_text(folder / f"{table.name}.tex", latex_text(table))
        write_table(table.frame, folder / f"{table.name}.csv")


def html_text(table: Table) -> str:
    """Return a page with one table, all digits kept in its ``data`` elements."""
    environment = Environment(autoescape=True, trim_blocks=False)
    return environment.from_string(_HTML).render(table=table)


def latex_text(table: Table) -> str:
    r"""Return a LaTeX table, to be read with ``\input``; it needs the package booktabs."""
    spec = "".join("r" if column.kind == "number" else "l" for column in table.head)
    heads = " & ".join(_latex_head(column) for column in table.head)
    rows = [
        " & ".join(_latex_cell(*column.parts(row)) for column in table.head) + r" \\"
        for row in table.records
    ]
    note = [r"\par\smallskip", rf"{{\footnotesize {_latex(table.note)}}}"] if table.note else []
    lines = [
        r"% Needs \usepackage{booktabs}; names in other scripts need XeLaTeX or LuaLaTeX.",
        r"\begin{table}", r"\centering", rf"\caption{{{_latex(table.title)}}}",
        rf"\label{{tab:{re.sub(r'[^A-Za-z0-9-]+', '-', table.name)}}}",
        rf"\begin{{tabular}}{{{spec}}}", r"\toprule", heads + r" \\", r"\midrule",
        *rows,
        r"\bottomrule", r"\end{tabular}", *note, r"\end{table}", "",
    ]  # fmt: skip
    return "\n".join(lines)


def _latex(text: str) -> str:
    return "".join(_LATEX.get(letter, letter) for letter in text)


def _latex_head(column: Column) -> str:
    symbol = column.symbol
    head = _latex(column.title) if symbol is None else f"${symbol[0]}_{symbol[1]}$"
    return head + (rf" ({_latex(column.unit)})" if column.unit else "")


def _latex_cell(text: str, error: str | None) -> str:
    """Write a number and its error in mathematics, so that minus signs are true."""
    cell = text if error is None else f"{text} ± {error}"
    if re.fullmatch(r"[−\d][\d.−± ]*", cell):
        return "$" + cell.replace("−", "-").replace(" ± ", r" \pm ") + "$"
    return _latex(cell)
