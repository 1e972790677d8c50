"""Hand-made sequences with known answers: one car drives along x, hides, and comes out again."""

from __future__ import annotations

import json
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any

import numpy as np
import pytest

from datmo.messages import Kind, Visibility
from eval.metrics.detection import match_detections
from eval.metrics.ghosts import ghosts, in_empty_space
from eval.metrics.history import History, moment
from eval.metrics.matching import Returns
from eval.metrics.pairing import Pairer
from eval.metrics.recovery import recovery_events
from eval.metrics.recovery_scores import (
    bootstrap_share,
    coast_errors,
    duration_class,
    recovery_detail,
    recovery_scores,
)

Place = tuple[float, float]


@dataclass
class Story:
    """Scans k at 10 Hz; object 0 at (k, 0) is hidden in `hidden`, others as told."""

    scans: int = 40
    hidden: frozenset[int] = frozenset(range(10, 20))
    gone: frozenset[int] = frozenset()
    tracks: dict[int, Callable[[int], Place | None]] = field(default_factory=dict)
    others: dict[int, Callable[[int], Place | None]] = field(default_factory=dict)
    detections: Callable[[int], list[Place]] = lambda _: []
    status: Callable[[int], int] = lambda _: 5
    velocity: Callable[[int], Place] = lambda _: (10.0, 0.0)
    yaw: Callable[[int], float] = lambda _: 0.0
    cov: float = 1.0
    rate: float = 10.0

    def play(self, make: Any) -> History:
        pairer, moments = Pairer(), []
        for k in range(self.scans):
            there = {0: (float(k), 0.0)} if k not in self.gone else {}
            there |= {i: p for i, f in self.others.items() if (p := f(k))}
            kept = {i: p for i, f in self.tracks.items() if (p := f(k))}
            shown = [Visibility.HIDDEN if i == 0 and k in self.hidden else Visibility.VISIBLE for i in there]
            truth = make.truth(
                make.boxes(list(there.values()), ids=list(there), velocity=self.velocity(k), yaw=self.yaw(k)),
                stamp=k / self.rate,
                visibility=shown,
            )
            frame = make.frame(
                tracks=make.tracks(
                    list(kept.values()), ids=list(kept), status=self.status(k), cov=self.cov * np.eye(5)
                ),
                boxes=make.boxes(self.detections(k)),
                stamp=k / self.rate,
            )
            returns = Returns(frame, truth)
            matched, paired = match_detections(frame, truth, returns), pairer.pair(frame, truth, returns)
            rows = np.flatnonzero(frame.tracks.confirmed())
            moments.append(moment(frame, truth, paired, matched, in_empty_space(frame, rows)))
        return History(moments)


def follow(k: int) -> Place:
    return (float(k), 0.0)


def until(scan: int) -> Callable[[int], Place | None]:
    return lambda k: (float(k), 0.0) if k < scan else None


def since(scan: int) -> Callable[[int], Place | None]:
    return lambda k: (float(k), 0.0) if k >= scan else None


def only(make: Any, story: Story) -> Any:
    events, censored = recovery_events(story.play(make))
    assert (len(events), censored) == (1, 0)
    return events[0]


def test_recovered(make: Any) -> None:
    event = only(make, Story(tracks={100: lambda k: (k + 0.5, -1.0 if k == 20 else 0.0)}, cov=0.25))
    assert (event.owner, event.outcome, event.motion, event.confusers) == (100, "recovered", "straight", 0)
    assert event.duration == pytest.approx(1.0)
    assert (event.latency, event.owner_latency) == (0.0, 0.0)
    assert event.nees == pytest.approx([0.25 / 0.25 / 2] * 10)
    assert event.coasts == {}  # it came out in the very scan that is 1 s after hiding


def test_new_id_and_lost(make: Any) -> None:
    tracks = {100: until(15), 101: since(24)}
    event = only(make, Story(tracks=tracks))
    assert event.outcome == "new id"
    assert event.latency == pytest.approx(0.4)
    assert event.owner_latency == 3.0
    event = only(make, Story(tracks={100: until(15), 101: since(31)}))
    assert event.outcome == "lost"
    assert event.latency == pytest.approx(1.1)
    assert only(make, Story(tracks={100: until(15)})).latency == 3.0


def test_wrong_when_the_owner_goes_with_another(make: Any) -> None:
    def astray(scans: int) -> Story:
        owner = lambda k: (k, 6.0) if 12 <= k < 12 + scans else (k, 0.0)  # noqa: E731
        return Story(tracks={100: owner}, others={1: lambda k: (k, 7.0)})

    event = only(make, astray(3))
    assert event.outcome == "wrong"
    assert event.confusers == 0
    assert only(make, astray(2)).outcome == "recovered"


def test_wrong_needs_the_gate_and_the_nearer_object(make: Any) -> None:
    outside = Story(tracks={100: lambda k: (k, 4.5 if 10 <= k < 20 else 0.0)}, others={1: lambda k: (k, 7.0)})
    assert only(make, outside).outcome == "recovered"
    tracks = {100: lambda k: (k, 1.0), 101: lambda k: (k, 2.5)}
    nearer_to_own = Story(tracks=tracks, others={1: lambda k: (k, 2.5)})
    event = only(make, nearer_to_own)
    assert event.outcome == "recovered"
    assert event.confusers == 1


def test_theft_takes_three_scans_of_another_objects_measurements(make: Any) -> None:
    def fed(scans: int, status: int = 5) -> Story:
        return Story(
            tracks={100: follow},
            others={1: lambda k: (k, 3.0)},
            detections=lambda k: [(k, 2.8)] if 12 <= k < 12 + scans else [],
            status=lambda k: status if 10 <= k < 20 else 5,
        )

    assert only(make, fed(3)).stolen
    assert not only(make, fed(2)).stolen
    assert not only(make, fed(3, status=6)).stolen  # coasting: nothing was taken in


def test_without_owner(make: Any) -> None:
    assert only(make, Story(tracks={100: lambda k: (k, 0) if k in (8, 9) else None})).owner is None
    event = only(make, Story(tracks={100: lambda k: (k, 0) if k in (6, 8, 9) else None}))
    assert event.owner == 100


def test_intervals_merge_when_parted_by_less_than_half_a_second(make: Any) -> None:
    def parted(by: int) -> frozenset[int]:
        return frozenset(range(10, 20)) | frozenset(range(20 + by, 27 + by))

    events, censored = recovery_events(Story(hidden=parted(4), scans=60).play(make))
    assert ([e.duration for e in events], censored) == ([pytest.approx(2.1)], 0)
    events, censored = recovery_events(Story(hidden=parted(5), scans=60).play(make))
    # The first is hidden again within 1 s of coming out; the second has had its half second.
    assert ([e.duration for e in events], censored) == ([pytest.approx(0.7)], 1)


@pytest.mark.parametrize(
    ("hidden", "gone", "events", "censored"),
    [
        (range(10, 14), (), 0, 0),  # too short to be an event at all
        (range(10, 15), (), 1, 0),
        (range(4, 15), (), 0, 1),  # the run begins too late
        (range(5, 15), (), 1, 0),
        (range(10, 30), (), 0, 1),  # the run ends before 1 s is over
        (range(10, 29), (), 1, 0),
        (range(10, 40), (), 0, 1),  # never comes out
        (range(10, 20), range(25, 40), 0, 1),  # leaves before it can be judged
        (range(10, 20), range(7), 0, 1),  # appears just before
    ],
)
def test_censoring(make: Any, hidden: range, gone: Any, events: int, censored: int) -> None:
    story = Story(hidden=frozenset(hidden), gone=frozenset(gone))
    found, cut = recovery_events(story.play(make))
    assert (len(found), cut) == (events, censored)


def test_error_along_and_across_and_share_alive(make: Any) -> None:
    away = lambda k: (k + 0.1 * max(k - 9, 0), 0.05 * max(k - 9, 0)) if k < 35 else None  # noqa: E731
    event = only(make, Story(scans=60, hidden=frozenset(range(10, 45)), tracks={100: away}))
    assert list(event.coasts) == [1.0, 2.0, 3.0]
    assert event.coasts[1.0].along == pytest.approx(1.1)
    assert event.coasts[2.0].across == pytest.approx(1.05)
    assert event.coasts[3.0] is None
    assert coast_errors([event], 2.0)["error"] == pytest.approx(np.hypot(2.1, 1.05))
    assert coast_errors([event], 3.0) == {
        "error": None,
        "along": None,
        "across": None,
        "alive": 0.0,
        "owners": 1.0,
    }
    assert duration_class(event) == "3-5"


@pytest.mark.parametrize(
    ("velocity", "yaw", "motion"),
    [
        (lambda _: (10.0, 0.0), lambda k: 0.02 * k, "straight"),
        (lambda _: (10.0, 0.0), lambda k: np.pi - 0.25 + 0.05 * k, "turning"),
        (lambda k: (0.0 if k == 15 else 5.0, 0.0), lambda _: 0.0, "stop-and-go"),
        (lambda _: (0.2, 0.0), lambda _: 0.0, "standing"),
    ],
)
def test_motion(make: Any, velocity: Any, yaw: Any, motion: str) -> None:
    assert only(make, Story(velocity=velocity, yaw=yaw)).motion == motion


def test_shares_sum_to_one_and_rate_all_counts_every_event(make: Any) -> None:
    stories = [
        Story(tracks={100: follow}),
        Story(tracks={100: until(15)}),
        Story(tracks={100: until(15), 101: since(22)}),
        Story(),
    ]
    events = [only(make, s) for s in stories]
    scores, detail = recovery_scores(events, 1), recovery_detail(events, 2, ["a", "a", "b", "b"])
    assert scores["recovery.events"] == detail["events"] == 3
    assert scores["recovery.rate"] == pytest.approx(1 / 3)
    assert scores["recovery.wrong_rate"] == 0.0
    assert scores["recovery.latency"] == pytest.approx((0 + 3 + 0.2) / 3)
    assert detail["latency_all"]["mean"] == pytest.approx((0 + 3 + 0.2 + 3) / 4)
    assert sum(v["share"] for v in detail["outcomes"].values()) == pytest.approx(1)
    assert (detail["rate_all"], detail["without_owner"], detail["censored"]) == (0.25, 1, 2)
    low, high = detail["outcomes"]["recovered"]["interval"]
    assert low <= 1 / 3 <= high
    assert json.loads(json.dumps(detail)) == json.loads(json.dumps(detail, allow_nan=False))


def test_bootstrap_resamples_whole_seeds() -> None:
    hits, seeds = [True] * 50 + [False] * 50, ["a"] * 50 + ["b"] * 50
    assert bootstrap_share(hits, seeds) == (0.0, 1.0)
    low, high = bootstrap_share(hits, ["a"] * 100) or (0.0, 0.0)
    assert low == pytest.approx(0.40, abs=0.03)
    assert high == pytest.approx(0.60, abs=0.03)
    assert bootstrap_share([], []) is None


def test_ghosts_live_until_they_die_or_find_another(make: Any) -> None:
    quiet = {"hidden": frozenset[int](), "gone": frozenset(range(20, 40))}
    (ghost,) = ghosts(Story(tracks={100: until(27)}, **quiet).play(make))
    assert (ghost.owner, ghost.seconds, ghost.cut) == (100, pytest.approx(0.7), False)
    (ghost,) = ghosts(Story(tracks={100: until(20)}, **quiet).play(make))
    assert ghost.seconds == 0
    (ghost,) = ghosts(Story(tracks={100: follow}, **quiet).play(make))
    assert (ghost.seconds, ghost.cut) == (pytest.approx(2.0), True)
    another = Story(tracks={100: follow}, others={1: lambda k: (k, 0.5) if k >= 23 else None}, **quiet)
    assert ghosts(another.play(make))[0].seconds == pytest.approx(0.3)
    assert ghosts(Story(tracks={100: follow}, hidden=frozenset()).play(make)) == []


def test_empty_space_is_seen_through_the_box(make: Any) -> None:
    tracks = make.tracks([(20, 0), (20, 0)], status=[6, 5])
    across = np.linspace(-0.3, 0.3, 40)
    beyond = np.column_stack([np.full(40, 40.0), 2 * across, np.zeros(40)])
    front = np.column_stack([np.full(40, 10.0), across / 2, np.zeros(40)])
    on_it = np.column_stack([np.full(40, 18.0), across, np.zeros(40)])
    rows = np.arange(2)
    assert in_empty_space(make.frame(tracks=tracks, points=beyond), rows).tolist() == [True, False]
    for hits in (front, np.concatenate([beyond, on_it]), np.zeros((0, 3))):
        assert not in_empty_space(make.frame(tracks=tracks, points=hits), rows).any()


def test_each_kind_has_its_own_reach(make: Any) -> None:
    walkers = make.boxes([(0, 0), (0, 0)], kind=[Kind.CAR, Kind.PEDESTRIAN])
    frame, truth = make.frame(), make.truth(walkers)
    returns = Returns(frame, truth)
    m = moment(
        frame,
        truth,
        Pairer().pair(frame, truth, returns),
        match_detections(frame, truth, returns),
        np.zeros(0, bool),
    )
    assert m.reach.tolist() == [4.0, 2.0]
    assert m.gate.tolist() == [2.0, 1.0]
