"""Stone Soup's joint association, timed."""

from __future__ import annotations

from datetime import datetime, timedelta
from time import perf_counter

import numpy as np

from datmo.arrays import F64
from datmo.errors import ConfigError
from datmo.messages import Boxes

STEP, ROUNDS = 0.1, 3
PLACE_STD = 0.15  # [m]


def joint_association(before: Boxes, now: Boxes) -> F64:
    """Milliseconds (ROUNDS,) of one JPDA with EHM: a track at each box of one scan, the boxes of the next.

    Raises:
        ConfigError: Stone Soup is not installed.
    """
    try:
        from stonesoup.dataassociator.probability import JPDAwithEHM
        from stonesoup.hypothesiser.probability import PDAHypothesiser
        from stonesoup.models.measurement.linear import LinearGaussian
        from stonesoup.models.transition.linear import CombinedLinearGaussianTransitionModel, ConstantVelocity
        from stonesoup.predictor.kalman import KalmanPredictor
        from stonesoup.types.detection import Detection
        from stonesoup.types.state import GaussianState
        from stonesoup.types.track import Track
        from stonesoup.updater.kalman import KalmanUpdater
    except ImportError:
        raise ConfigError("stonesoup is not installed, and it is the rival; pip install stonesoup") from None
    start = datetime(2000, 1, 1)
    later, prior = start + timedelta(seconds=STEP), np.diag([0.1, 1.0, 0.1, 1.0])
    model = LinearGaussian(4, (0, 2), PLACE_STD**2 * np.eye(2))
    motion = CombinedLinearGaussianTransitionModel([ConstantVelocity(1.5), ConstantVelocity(1.5)])
    guess = PDAHypothesiser(
        KalmanPredictor(motion),
        KalmanUpdater(model),
        clutter_spatial_density=0.005,
        prob_detect=0.9,
        prob_gate=0.999,
    )
    tracks = {
        Track([GaussianState([[x], [0], [y], [0]], prior, timestamp=start)]) for x, y, _ in before.center
    }
    found = {Detection([[x], [y]], timestamp=later, measurement_model=model) for x, y, _ in now.center}
    spent = []
    for _ in range(ROUNDS):
        begin = perf_counter()
        JPDAwithEHM(guess).associate(tracks, found, later)
        spent.append(1e3 * (perf_counter() - begin))
    return np.array(spent)
