"""Writing results: never over what is there, never half."""

from __future__ import annotations

import shutil
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from datmo.errors import OutputError


def refuse_existing(path: Path, force: bool) -> None:
    """Raise where a result would overwrite something.

    Raises:
        OutputError: `path` exists and `force` is not set, or its parent is a file.
    """
    if path.exists() and not force:
        raise OutputError(f"{path} exists; results are not overwritten; give --force or another --out")
    for parent in path.absolute().parents:
        if parent.exists():
            if not parent.is_dir():
                raise OutputError(f"{path} cannot be written: {parent} is no folder; give another --out")
            break


def unused(path: Path) -> Path:
    """`path`, or the first of path-2, path-3 ... that does not exist."""
    if not path.exists():
        return path
    number = 2
    while path.with_name(f"{path.name}-{number}").exists():
        number += 1
    return path.with_name(f"{path.name}-{number}")


@contextmanager
def writing_folder(path: Path, force: bool = False) -> Iterator[Path]:
    """A folder beside `path` to write into; it becomes `path` when all went well, else it is removed.

    With `force`, what is at `path` is replaced as the last step.

    Raises:
        OutputError: `path` exists and `force` is not set.
    """
    refuse_existing(path, force)
    with _readable(path):
        path.parent.mkdir(parents=True, exist_ok=True)
        beside = Path(tempfile.mkdtemp(prefix=f".{path.name}.", dir=path.parent))
        beside.chmod(0o755)
    try:
        yield beside
        with _readable(path):
            _remove(path)
            beside.rename(path)
    finally:
        shutil.rmtree(beside, ignore_errors=True)


def write_file(path: Path, data: bytes, force: bool = False) -> None:
    """Write a file beside, then rename it to `path`.

    Raises:
        OutputError: `path` exists and `force` is not set, or is a folder.
    """
    refuse_existing(path, force)
    if path.is_dir():
        raise OutputError(f"{path} is a folder; a file is written here; give --out a file name")
    with _readable(path):
        path.parent.mkdir(parents=True, exist_ok=True)
        with tempfile.NamedTemporaryFile(prefix=f".{path.name}.", dir=path.parent, delete=False) as file:
            beside = Path(file.name)
            try:
                file.write(data)
            except BaseException:
                beside.unlink(missing_ok=True)
                raise
        beside.chmod(0o644)
        beside.replace(path)


def _remove(path: Path) -> None:
    if path.is_dir() and not path.is_symlink():
        shutil.rmtree(path)
    else:
        path.unlink(missing_ok=True)


@contextmanager
def _readable(path: Path) -> Iterator[None]:
    """Turn what the file system says into an error of ours."""
    try:
        yield
    except OutputError:
        raise
    except OSError as error:
        raise OutputError(f"{path} cannot be written: {error.strerror}; give another --out") from error
