"""The house rules that a linter does not know: small files, small functions, one-way imports."""

from __future__ import annotations

import ast
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]
SOURCES = sorted(p for d in ("datmo", "sim", "scenarios", "eval") for p in (ROOT / d).rglob("*.py"))
FILE_LINES, FUNCTION_LINES = 300, 40


def _imports(path: Path) -> set[str]:
    names: set[str] = set()
    for node in ast.walk(ast.parse(path.read_text())):
        if isinstance(node, ast.Import):
            names |= {alias.name.split(".")[0] for alias in node.names}
        elif isinstance(node, ast.ImportFrom) and node.module:
            names.add(node.module.split(".")[0])
    return names


@pytest.mark.parametrize("path", SOURCES, ids=lambda p: str(p.relative_to(ROOT)))
def test_rooms_stay_small(path: Path) -> None:
    text = path.read_text()
    assert len(text.splitlines()) <= FILE_LINES
    for node in ast.walk(ast.parse(text)):
        if isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef):
            lines = (node.end_lineno or node.lineno) - node.lineno + 1
            assert lines <= FUNCTION_LINES, f"{path.name}:{node.lineno} {node.name} has {lines} lines"


@pytest.mark.parametrize("path", SOURCES, ids=lambda p: str(p.relative_to(ROOT)))
def test_eval_is_never_imported_bare(path: Path) -> None:
    """`import eval` would shadow the builtin; write `from eval.x import y`."""
    for node in ast.walk(ast.parse(path.read_text())):
        if isinstance(node, ast.Import):
            assert all(alias.name.split(".")[0] != "eval" for alias in node.names)


@pytest.mark.parametrize(
    ("package", "only"), [("highway_env", "sim/scene/traffic.py"), ("embreex", "sim/scan/embree.py")]
)
def test_one_file_knows_each_engine(package: str, only: str) -> None:
    users = [p.relative_to(ROOT).as_posix() for p in SOURCES if package in _imports(p)]
    assert users == [only]


def test_importing_datmo_is_light() -> None:
    code = (
        "import sys, datmo, datmo.messages; "
        "heavy = {'numba', 'pydantic', 'gymnasium', 'sim', 'eval', 'scipy.stats'} & set(sys.modules); "
        "assert not heavy, heavy"
    )
    subprocess.run([sys.executable, "-c", code], check=True, cwd=ROOT)
