from __future__ import annotations

from pathlib import Path

import pytest

from datmo.errors import OutputError
from eval.output import unused, write_file, writing_folder


def fill_up(path: Path) -> None:
    path.write_text("half")
    raise OSError("the disk is full")


def test_a_folder_appears_whole_or_not_at_all(tmp_path) -> None:
    target = tmp_path / "deep" / "run"
    with pytest.raises(OSError, match="full"), writing_folder(target) as beside:
        fill_up(beside / "half.txt")
    assert list((tmp_path / "deep").iterdir()) == []
    with writing_folder(target) as beside:
        (beside / "whole.txt").write_text("whole")
        assert not target.exists()
    assert (target / "whole.txt").read_text() == "whole"
    assert [p.name for p in (tmp_path / "deep").iterdir()] == ["run"]


def test_what_exists_is_kept_unless_forced(tmp_path) -> None:
    target = tmp_path / "run"
    target.mkdir()
    (target / "old.txt").write_text("old")
    with pytest.raises(OutputError, match="--force"), writing_folder(target):
        pass
    with pytest.raises(OSError, match="full"), writing_folder(target, force=True) as beside:
        fill_up(beside / "half.txt")
    assert (target / "old.txt").exists()
    with writing_folder(target, force=True) as beside:
        (beside / "new.txt").write_text("new")
    assert [p.name for p in target.iterdir()] == ["new.txt"]


def test_files_too(tmp_path) -> None:
    path = tmp_path / "a" / "b.json"
    write_file(path, b"1")
    with pytest.raises(OutputError, match="exists"):
        write_file(path, b"2")
    assert path.read_bytes() == b"1"
    write_file(path, b"2", force=True)
    assert path.read_bytes() == b"2"
    with pytest.raises(OutputError, match="folder"):
        write_file(tmp_path / "a", b"3", force=True)
    with pytest.raises(OutputError, match="no folder"):
        write_file(path / "c", b"4")
    assert [p.name for p in (tmp_path / "a").iterdir()] == ["b.json"]


def test_unused_names_count_up(tmp_path) -> None:
    path = tmp_path / "run"
    assert unused(path) == path
    path.mkdir()
    (tmp_path / "run-2").mkdir()
    assert unused(path) == tmp_path / "run-3"
