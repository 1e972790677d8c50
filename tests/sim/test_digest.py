from __future__ import annotations

import dataclasses
import hashlib
import os
import subprocess
import sys

import gymnasium as gym
import numpy as np
import pytest
from gymnasium.vector import AsyncVectorEnv, SyncVectorEnv

from datmo.messages import Scan
from scenarios.spec import Scenario
from sim.digest import Digest, digest
from sim.env import LidarEnv

SCANS = 3


def play(scenario: Scenario, seed: int) -> str:
    env = LidarEnv(scenario)
    infos = [env.reset(seed=seed)[1]] + [env.step(0)[4] for _ in range(SCANS - 1)]
    env.close()
    return digest((i["scan"], i["truth"]) for i in infos)


PROGRAM = f"""
import os, sys
if sys.argv[2] == "one" and hasattr(os, "sched_setaffinity"):
    os.sched_setaffinity(0, {{min(os.sched_getaffinity(0))}})
from scenarios.spec import Scenario
from sim.digest import digest
from sim.env import LidarEnv
env = LidarEnv(Scenario.model_validate_json(sys.argv[1]))
infos = [env.reset(seed=3)[1]] + [env.step(0)[4] for _ in range({SCANS - 1})]
print(digest((i["scan"], i["truth"]) for i in infos))
"""


@pytest.mark.parametrize("processors", ["one", pytest.param("all", marks=pytest.mark.long)])
def test_one_digest_in_a_fresh_process_whatever_its_threads(tiny: Scenario, processors: str) -> None:
    run = [sys.executable, "-W", "error", "-c", PROGRAM, tiny.model_dump_json(), processors]
    fresh = subprocess.run(run, check=True, capture_output=True, text=True, env={**os.environ})
    assert fresh.stdout.strip() == play(tiny, 3)


def test_one_digest_in_one_process_after_another_episode(tiny: Scenario) -> None:
    first = play(tiny, 3)
    assert play(tiny, 4) != first
    assert play(tiny, 3) == first


@pytest.mark.long
def test_one_digest_in_both_vector_environments(tiny: Scenario) -> None:
    def make() -> gym.Env:
        return gym.make("sim:datmo/Lidar-v0", scenario=tiny)

    found, ranges = [], []
    for vector in (SyncVectorEnv([make, make]), AsyncVectorEnv([make, make], context="spawn")):
        obs, info = vector.reset(seed=[3, 4])
        ranges.append(obs["range"].copy())
        infos = [info]
        infos += [vector.step(np.zeros(2, np.int64))[4] for _ in range(SCANS - 1)]
        vector.close()
        found.append([digest((i["scan"][e], i["truth"][e]) for i in infos) for e in range(2)])
    assert found[0] == found[1] == [play(tiny, 3), play(tiny, 4)]
    np.testing.assert_array_equal(ranges[0], ranges[1])
    assert not np.array_equal(ranges[0][0], ranges[0][1])


def test_the_digest_is_sha256_of_names_types_shapes_and_bytes() -> None:
    scan = Scan(points=np.array([[1.0, 2.0, 3.0]]))
    record = Digest()
    record.add(scan)
    text = b"Scan"
    for field in dataclasses.fields(scan):
        value = np.ascontiguousarray(getattr(scan, field.name))
        if field.metadata.get("compare", True):
            text += f"{field.name} {value.dtype.str} {value.shape}".encode() + value.tobytes()
    assert record.hex() == hashlib.sha256(text).hexdigest()


def test_every_field_counts(tiny: Scenario) -> None:
    env = LidarEnv(tiny)
    info = env.reset(seed=0)[1]
    scan, truth = info["scan"], info["truth"]
    before = digest([(scan, truth)])
    solo = truth.solo.copy()
    solo[0] += 1
    lost = dataclasses.replace(truth.lost, thing=truth.lost.thing + 1)
    changed = [
        (dataclasses.replace(scan, stamp=scan.stamp + 1e-9), truth),
        (scan, dataclasses.replace(truth, solo=solo)),
        (scan, dataclasses.replace(truth, lost=lost)),
    ]
    assert len({before, *(digest([pair]) for pair in changed)}) == 4
