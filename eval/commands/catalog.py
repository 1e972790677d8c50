"""datmo list: the scenarios that ship with the project."""

from __future__ import annotations

from typing import Annotated

import typer

from datmo.errors import ScenarioError, nearest


def catalog(
    tag: Annotated[str | None, typer.Option("--tag", help="Only scenarios that carry this tag.")] = None,
) -> None:
    """List the scenarios.

    \b
    Examples:
      datmo list
      datmo list --tag occlusion
    """
    from rich.table import Table

    from eval.console import stdout
    from scenarios.catalog import names
    from scenarios.load import load

    found = [load(name) for name in names()]
    tags = sorted({t for scenario in found for t in scenario.tags})
    if tag is not None and tag not in tags:
        raise ScenarioError(f"no scenario carries the tag {tag!r}; {nearest(tag, tags)}")
    table = Table(box=None, pad_edge=False, header_style="bold")
    table.add_column("name", no_wrap=True)
    table.add_column("tags")
    table.add_column("what happens", overflow="fold")
    for scenario in found:
        if tag is None or tag in scenario.tags:
            table.add_row(scenario.name, ", ".join(scenario.tags), scenario.summary)
    stdout().print(table, soft_wrap=False)
