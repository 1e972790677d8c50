"""datmo list: the scenarios that ship with the project, and what there is to put into one."""

from __future__ import annotations

from typing import Annotated

import typer

from datmo.errors import ScenarioError, nearest


def catalog(
    tag: Annotated[str | None, typer.Option("--tag", help="Only scenarios that carry this tag.")] = None,
    assets: Annotated[
        bool, typer.Option("--assets", help="List vehicles, persons, things and grounds instead.")
    ] = False,
) -> None:
    """List the scenarios, or what can stand in one.

    \b
    Examples:
      datmo list
      datmo list --tag occlusion
      datmo list --assets
    """
    if assets and tag is not None:
        raise ScenarioError(f"--tag {tag} chooses scenarios and --assets lists none; give one of the two")
    if assets:
        _assets()
    else:
        _scenarios(tag)


def _scenarios(tag: str | None) -> None:
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


def _assets() -> None:
    from rich.table import Table

    from eval.console import stdout
    from sim.picture.gallery.listing import catalogue

    table = Table(box=None, pad_edge=False, header_style="bold")
    for name in ("group", "name", "kind", "length × width × height [m]"):
        table.add_column(name, no_wrap=True)
    table.add_column("triangles", justify="right", no_wrap=True)
    table.add_column("what", overflow="fold")
    for group, rows in catalogue().items():
        for row in rows:
            table.add_row(group, row.name, row.kind, row.size, row.triangles, row.note)
    stdout().print(table, soft_wrap=False)
