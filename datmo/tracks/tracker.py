"""The tracker: IMM-UKF-JPDA with life in time and retained boxes (method.md 9-14)."""

from __future__ import annotations

from typing import Literal

import numpy as np

from datmo.arrays import F64, Bool
from datmo.errors import ConfigError, MessageError
from datmo.messages import Boxes, Sight, Tracks
from datmo.tracks.association.assign import assign, innovations, likeliest
from datmo.tracks.association.existence import survive
from datmo.tracks.bank import Bank
from datmo.tracks.config import TrackerConfig
from datmo.tracks.estimate import Estimator
from datmo.tracks.filters.base import Filters
from datmo.tracks.filters.engine_filterpy import FilterpyFilters
from datmo.tracks.filters.ukf import BatchedFilters
from datmo.tracks.management import manage
from datmo.tracks.management.birth import Newborns
from datmo.tracks.management.confirm import as_bank, take_over, unclaimed
from datmo.tracks.management.course import set_course
from datmo.tracks.management.recall import recall
from datmo.tracks.measurement.box import own_ends, retain
from datmo.tracks.measurement.measured import Measured, measured, sound
from datmo.tracks.measurement.trust import are_logits
from datmo.tracks.measurement.unseen import hold_back
from datmo.tracks.measurement.visibility import shares
from datmo.tracks.models import velocity
from datmo.tracks.report import as_tracks, predicted_boxes

HIT = 0.5  # association probability from which a track counts as seen
UNSEEN = 1 - 1e-3  # probability of no box from which it was not seen at all
ENGINES: dict[str, type[Filters]] = {"batched": BatchedFilters, "filterpy": FilterpyFilters}


class Tracker:
    """Tracks boxes over time; `Tracker().step(boxes, stamp)` suffices.

    Args:
        config: tuning.
        engine: "batched", or "filterpy": the same tracker on filterpy's filters, slow and readable.

    Attributes:
        notes: what the last step has to say: boxes dropped, links cut, covariances repaired.
        nis: for each track id that was hit in the last step, the normalised innovation squared of
            its likeliest box, and its dimension.
    """

    def __init__(
        self, config: TrackerConfig | None = None, engine: Literal["batched", "filterpy"] = "batched"
    ) -> None:
        if engine not in ENGINES:
            raise ConfigError(f"engine {engine!r} is not known; choose one of {sorted(ENGINES)}")
        self.config = config or TrackerConfig()
        self._estimator = Estimator(self.config, ENGINES[engine]())
        self._next_id = 1
        self.reset()

    def reset(self) -> None:
        """Forget every track; ids go on, so none is used twice."""
        shape = len(self.config.models), self._estimator.size
        self._bank, self._lost = Bank.empty(*shape), Bank.empty(*shape)
        self._new = Newborns.start(
            np.zeros(0, np.int64), 0.0, measured(Boxes.empty(), False, self.config), self.config
        )
        self._stamp: float | None = None
        self._logits = False
        self._dt = 0.0
        self.notes: dict[str, str] = {}
        self.nis: dict[int, tuple[float, int]] = {}

    def step(self, boxes: Boxes, stamp: float, sight: Sight | None = None) -> Tracks:
        """Take the boxes of one scan.

        Args:
            boxes: detections [world]. Boxes that are not finite or have a side that is not positive
                are left out, with a note.
            stamp: time of the scan [s]; must be later than the last one.
            sight: how far the rays of this scan saw; tells expected visibility, empty space and
                which end of a box is real. Without it every place counts as visible and boxes
                count as whole.

        Returns:
            Every valid track, by id; `status >= 5` is a confirmed one.

        Raises:
            MessageError: stamp is not finite or does not follow the last one (`reset()` first).
        """
        self.notes, self.nis = {}, {}
        stamp, dt = float(stamp), self._elapsed(float(stamp))
        given, before = self._accept(boxes), self._bank.mu
        mean, P = self._predict(dt)
        bank = self._bank
        visible, empty = self._expect(mean, P, sight)
        pairs, links, ratio = assign(bank, mean, P, given, visible, sight, self.config)
        best = likeliest(pairs, links, HIT)
        self.nis = innovations(bank, mean, P, best)
        self._estimator.update(bank, pairs, links, ratio, before)
        hit = links.missed < HIT
        mean, P = self._held_back(links.missed > UNSEEN, sight)
        bank.mark(hit, stamp, manage.BREAK)
        mean = retain(bank, given, best, mean, dt, self.config)
        manage.charge(bank, hit, visible, empty, dt, self.config)
        manage.judge_motion(bank, mean, P, hit, stamp, self.config)
        set_course(bank, mean, hit, stamp, dt)
        bank.remember(stamp, mean)
        self._note_cuts(links.cut)
        free = unclaimed(given.boxes, pairs, links, bank, mean, hit, self.config)
        self._births(given.select(free), sight)
        return self._settle(sight is not None)

    def predicted(self, stamp: float) -> Boxes:
        """Boxes of the confirmed tracks where they are expected at `stamp` [s]; changes nothing."""
        last = stamp if self._stamp is None else self._stamp
        bank, jitters = self._bank.select(np.arange(len(self._bank))), self._estimator.filters.jitters
        mean, _ = self._estimator.predict(bank, max(float(stamp) - last, 0.0))
        self._estimator.filters.jitters = jitters
        return predicted_boxes(bank, mean)

    def _elapsed(self, stamp: float) -> float:
        if not np.isfinite(stamp):
            raise MessageError(f"stamp {stamp} is not finite; give the time of the scan in seconds")
        if self._stamp is not None and stamp <= self._stamp:
            raise MessageError(
                f"stamp {stamp} s does not follow the last one, {self._stamp} s; "
                "stamps must increase; call reset() to begin a new sequence"
            )
        dt = 0.0 if self._stamp is None else stamp - self._stamp
        if dt > self.config.max_hidden:
            self.reset()
            self.notes["gap"] = f"{dt:.1f} s without a scan; all tracks ended"
            dt = 0.0
        self._stamp, self._dt = stamp, dt
        return dt

    def _accept(self, boxes: Boxes) -> Measured:
        """The boxes that are sound and likely to be real."""
        good = sound(boxes)
        if not good.all():
            bad = f"{int((~good).sum())} of {len(boxes)}"
            why = "a value that is not finite or a side that is not positive"
            self.notes["boxes dropped"] = f"{bad} with {why}"
            boxes = boxes.select(good)
        self._logits = self._logits or are_logits(boxes.score)
        logits = {"auto": self._logits, "logit": True, "ignored": False}[self.config.scores]
        return measured(boxes, logits, self.config)

    def _predict(self, dt: float) -> tuple[F64, F64]:
        self._new.predict(dt, self.config)
        self._bank.existence = survive(self._bank.existence, dt, self.config)
        if len(self._lost) == 0:
            return self._estimator.predict(self._bank, dt)
        count, both = len(self._bank), self._bank.join(self._lost)
        mean, P = self._estimator.predict(both, dt)
        self._bank, self._lost = both.split(count)
        return mean[:count], P[:count]

    def _expect(self, mean: F64, P: F64, sight: Sight | None) -> tuple[F64, F64]:
        if sight is None:
            return np.ones(len(mean)), np.zeros(len(mean))
        center = np.column_stack([mean[:, :2] + self._lag(mean, sight), self._bank.z])
        return shares(sight, center, self._bank.size, self._bank.yaw, P[:, :2, :2])

    def _held_back(self, unseen: Bool, sight: Sight | None) -> tuple[F64, F64]:
        mean, P = self._estimator.combined(self._bank)
        if sight is None or not self.config.hold_back:
            return mean, P
        hold_back(self._bank, unseen, mean, P, self._lag(mean, sight), sight)
        return self._estimator.combined(self._bank)

    @staticmethod
    def _lag(mean: F64, sight: Sight) -> F64:
        """(t, 2) [m] from where tracks are at the stamp to where they were when the rays came by."""
        return np.asarray(sight.when(mean[:, :2])[:, None] * velocity(mean))

    def _note_cuts(self, cut: int) -> None:
        if cut:
            self.notes["association bounded"] = f"the {cut} weakest links of crowded groups were cut"
        if self._estimator.filters.jitters:
            self.notes["covariances repaired"] = f"{self._estimator.filters.jitters} in this step"
            self._estimator.filters.jitters = 0

    def _births(self, rest: Measured, sight: Sight | None) -> None:
        new, config = self._new, self.config
        rows, columns = new.match(rest, config)
        taken = rest.select(columns)
        new.correct(rows, taken, None if sight is None else own_ends(sight, taken.boxes), config)
        missed = np.ones(len(new), np.bool_)
        missed[rows] = False
        new.misses += missed
        fresh = rest.trust >= config.birth_trust
        fresh[columns] = False
        born = rest.select(fresh)
        ids = np.arange(self._next_id, self._next_id + len(born))
        self._next_id += len(born)
        kept = new.select(new.misses <= config.birth_misses)
        self._new = kept.join(Newborns.start(ids, float(self._stamp or 0.0), born, config))

    def _settle(self, has_sight: bool) -> Tracks:
        """Confirm, recall, bury; what is alive now."""
        config, stamp = self.config, float(self._stamp or 0.0)
        ripe = self._new.ripe(config)
        if ripe.any():
            grown, self._new = self._new.select(ripe), self._new.select(~ripe)
            self._welcome(as_bank(grown, stamp, self._estimator.size, config))
        mean, P = self._bury(has_sight)
        share = manage.spent(self._bank, stamp, self._dt, has_sight, config)
        return as_tracks(self._bank, mean, P, manage.status(share), self._new, stamp, config)

    def _welcome(self, grown: Bank) -> None:
        """Take in tracks that were confirmed just now; some may be those that coast or were lost."""
        pool, count = self._bank.join(self._lost), len(self._bank)
        mean, P = self._estimator.combined(pool)
        old, young = recall(pool, mean, P, grown, float(self._stamp or 0.0), self.config)
        rest, taken = np.ones(len(grown), np.bool_), np.zeros(len(pool), np.bool_)
        rest[young], taken[old] = False, True
        back = take_over(pool.select(old), grown.select(young))
        self._lost = self._lost.select(~taken[count:])
        self._bank = self._bank.select(~taken[:count]).join(back).join(grown.select(rest))

    def _bury(self, has_sight: bool) -> tuple[F64, F64]:
        """Keep the living; their combined mean and covariance."""
        bank, config, stamp = self._bank, self.config, float(self._stamp or 0.0)
        mean, P = self._estimator.combined(bank)
        living = manage.alive(mean, P, manage.spent(bank, stamp, self._dt, has_sight, config), config)
        double = manage.duplicates(bank, mean, config)
        kept = living & ~double
        if not kept.all():
            finite = np.isfinite(mean).all(axis=1)
            self._lost = self._lost.join(bank.select(~living & ~double & finite))
            self._bank, mean, P = bank.select(kept), mean[kept], P[kept]
        recent = stamp - self._lost.seen < config.max_hidden
        if not recent.all():
            self._lost = self._lost.select(recent)
        return mean, P
