"""Tables of the benchmarks as plain rows of text, for the terminal and for markdown."""

from __future__ import annotations

from dataclasses import dataclass

from rich.markup import escape
from rich.table import Table


@dataclass(frozen=True)
class Rows:
    """A table: a title, the heads of its columns and its rows; the first `left` columns are text."""

    title: str
    heads: tuple[str, ...]
    rows: tuple[tuple[str, ...], ...]
    left: int = 2


def say(value: float | None, factor: float = 1, digits: int = 3, sign: bool = False) -> str:
    """A figure as text; a dash where there is none."""
    return "-" if value is None else f"{factor * value:{'+' if sign else ''}.{digits}f}"


def rich_table(table: Rows) -> Table:
    """For the terminal."""
    made = Table(box=None, header_style="bold", pad_edge=False)
    for i, head in enumerate(table.heads):
        made.add_column(escape(head), justify="left" if i < table.left else "right")
    for row in table.rows:
        made.add_row(*map(escape, row))
    return made


def markdown(table: Rows) -> str:
    """For a page."""
    lines = [table.heads, tuple("---" if i < table.left else "---:" for i in range(len(table.heads)))]
    return "".join("| " + " | ".join(row) + " |\n" for row in (*lines, *table.rows))
