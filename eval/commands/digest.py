"""datmo digest: one SHA-256 over all scans and truths of an episode."""

from __future__ import annotations

from eval.commands import options as o


def digest(
    scenario: o.Scenario,
    seed: o.Seed = 0,
    frames: o.Frames = None,
    set_: o.Settings = None,
) -> None:
    """Print the SHA-256 of an episode's scans and truths.

    The same scenario, seed and versions give the same digest in any process, with any number of
    threads. Compare it after an upgrade, or between two machines of the same kind.

    \b
    Examples:
      datmo digest rough-crossing
      datmo digest rough-crossing --seed 7 --frames 20
    """
    from eval import console
    from eval.episode import episode, scans_to_play
    from scenarios.load import load
    from sim import digest as digesting
    from sim.env import LidarEnv

    world = load(scenario, o.settings(set_))
    total = scans_to_play(world, frames)
    env = LidarEnv(world)
    record = digesting.Digest()
    with console.progress("scans", total) as tell:
        for count, info in enumerate(episode(env, world, seed, total), start=1):
            record.add(info["scan"])
            record.add(info["truth"])
            tell(count, "")
    env.close()
    console.stdout().print(f"{record.hex()}  {world.name}, seed {seed}, {count} scans", markup=False)
