from __future__ import annotations

from pathlib import Path

import pytest

from eval.cli import call
from eval.commands.gallery import text
from sim.picture.gallery import SHEETS
from sim.picture.gallery.exhibits import things
from sim.picture.gallery.listing import catalogue
from sim.picture.gallery.sheet import Cell, exhibit
from sim.scene.scenery.kinds import SORTS

DOCS = Path(__file__).parents[2] / "docs"


def test_list_tells_every_asset(capsys) -> None:
    assert call(["list", "--assets"]) == 0
    said = capsys.readouterr().out
    for rows in catalogue().values():
        assert all(row.name in said for row in rows)
    assert call(["list", "--assets", "--tag", "smoke"]) == 2
    assert "one of the two" in capsys.readouterr().err


def test_gallery_writes_sheets_and_a_page(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys) -> None:
    def cells() -> list[Cell]:
        return [exhibit(things()[0])]

    for name in SHEETS:
        monkeypatch.setitem(SHEETS, name, (cells, 1))
    out = tmp_path / "show"
    assert call(["gallery", "--out", str(out)]) == 0
    assert {p.name for p in out.iterdir()} == {f"{name}.png" for name in SHEETS}
    page = (tmp_path / "show.md").read_text()
    assert "(show/things.png)" in page
    assert all(f"`{kind}`" in page for kind in SORTS)
    assert call(["gallery", "--out", str(out)]) == 2
    assert "exists" in capsys.readouterr().err
    assert call(["gallery", "--out", str(out), "--force"]) == 0


def test_the_page_in_docs_is_of_today() -> None:
    assert (DOCS / "gallery.md").read_text() == text(catalogue(), "gallery"), "run `datmo gallery --force`"
    for name in SHEETS:
        assert (DOCS / "gallery" / f"{name}.png").stat().st_size < 600_000
