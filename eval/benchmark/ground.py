"""The ground benchmark's three questions: the grid beside peers, the ablation, and Table 5.1."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

from eval.benchmark.ground_ablation import ABLATIONS, contestants, costs
from eval.benchmark.ground_grid import play
from eval.benchmark.ground_methods import best, check_methods, ours
from eval.benchmark.ground_peers import peers
from eval.benchmark.ground_real import play_real, real_paths, real_table
from eval.benchmark.ground_report import Report
from eval.benchmark.ground_scenes import Scene, check, scenes
from eval.benchmark.ground_table import ablation_table, tables
from eval.benchmark.ground_table51 import sentences, table51, table51_rows
from eval.benchmark.ground_verdict import verdict

Tell = Callable[[int, str], None]


@dataclass(frozen=True)
class Grid:
    """Which scenes: ISO classes, "flat" or rms heights [m] as text; grades [%]; one seed."""

    classes: Sequence[str]
    grades: Sequence[float]
    seed: int = 0
    scans: int = 1

    def check(self) -> None:
        """Refuse what cannot be made.

        Raises:
            ConfigError: an unknown class, an impossible grade, an empty list.
        """
        check(self.classes, self.grades, self.seed, self.scans)

    def __len__(self) -> int:
        return len(self.classes) * len(self.grades)

    def scenes(self, tell: Tell | None) -> Iterator[Scene]:
        """The scenes, made as they are asked for."""
        return scenes(self.classes, self.grades, self.seed, self.scans, tell)


def compare(
    grid: Grid, methods: Sequence[str], rounds: int, real: Path | None = None, tell: Tell | None = None
) -> Report:
    """Our methods beside the peers, on the grid and on real sweeps.

    Args:
        methods: names of `datmo.ground.METHODS`. rounds: over which times are medians.
        real: folder of real sweeps; None looks at the default place, and does without where it is empty.
        tell: told how many scenes are done, and the name of the next one.

    Raises:
        ConfigError: an unknown method or scene, or no round. CloudFileError: no sweep in `real`.
    """
    grid.check()
    own = [ours(method) for method in check_methods(methods)]
    (others, notes), (paths, note) = peers(), real_paths(real)
    everyone = [*own, *others]
    rows = play(everyone, grid.scenes(tell), rounds)
    swept = play_real(everyone, paths, rounds)
    verdicts = [v for method in methods if (v := verdict(rows, method)) is not None]
    shown = [*tables(rows), *([real_table(swept)] if swept else [])]
    said = [*map(str, verdicts), *notes, *([note] if note else [])]
    extra = {"verdicts": [asdict(v) for v in verdicts], "real": [asdict(row) for row in swept]}
    return Report(_settings(grid, methods, rounds), rows, shown, said, extra)


def ablate(grid: Grid, method: str | None, rounds: int, tell: Tell | None = None) -> Report:
    """A method with each of its ideas switched off in turn; None takes the best one.

    Raises:
        ConfigError: an unknown method or scene, or no round.
    """
    grid.check()
    (method,) = check_methods([method or best()])
    others, notes = peers()
    rows = play([*contestants(method), *others], grid.scenes(tell), rounds)
    own = [row for row in rows if row.method not in {peer.name for peer in others}]
    found = costs(own)
    extra = {"ablation": dict(found), "overrides": {k: dict(v) for k, v in ABLATIONS.items()}}
    return Report(_settings(grid, [method], rounds), own, [ablation_table(found)], notes, extra)


def anew(grid: Grid, methods: Sequence[str], rounds: int, tell: Tell | None = None) -> Report:
    """The thesis's Table 5.1, and whether Z-L beats Z; the first method is what the others are held to.

    Raises:
        ConfigError: an unknown method or scene, or no round.
    """
    grid.check()
    lines = table51(check_methods(methods), grid.scenes(tell), rounds)
    extra = {"table51": [asdict(line) for line in lines]}
    return Report(_settings(grid, methods, rounds), [], [table51_rows(lines)], sentences(lines), extra)


def _settings(grid: Grid, methods: Sequence[str], rounds: int) -> dict[str, Any]:
    return {**asdict(grid), "methods": list(methods), "rounds": rounds}
