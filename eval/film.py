"""A run as pictures in a row: GIF, MP4, or the last one as PNG."""

from __future__ import annotations

import io
import tempfile
from collections.abc import Sequence
from pathlib import Path

import numpy as np
from PIL import Image

from datmo.arrays import U8
from datmo.errors import ConfigError, OutputError, nearest
from eval.episode import episode, scans_to_play
from eval.report.recording import encode
from eval.run import OnStep
from eval.testbed import make_testbed
from eval.view import BirdsEye
from scenarios.spec import Scenario

FORMS = (".gif", ".mp4", ".png")


def check(path: Path) -> None:
    """Raise for a file name that says no known form.

    Raises:
        ConfigError: with the forms there are.
    """
    if path.suffix not in FORMS:
        raise ConfigError(f"{path} names no picture or film; {nearest(path.suffix, FORMS)}")


def shoot(
    scenario: Scenario,
    seed: int,
    frames: int | None,
    ground: str | None,
    radius: float,
    pixels: int,
    only_last: bool,
    on_step: OnStep,
) -> list[U8]:
    """Play an episode and draw each scan, or only the last."""
    total = scans_to_play(scenario, frames)
    env, eye, shots = make_testbed(scenario, ground=ground), BirdsEye(radius, pixels), []
    try:
        for k, info in enumerate(episode(env, scenario, seed, total)):
            eye.follow(info["frame"])
            shots.append(eye.draw(info["frame"], info["truth"]))
            if only_last:
                del shots[:-1]
            on_step(k + 1, total, info)
    finally:
        env.close()
    return shots


def develop(shots: Sequence[U8], form: str, rate: float) -> bytes:
    """The bytes of the film or picture.

    Args:
        shots: pictures (h, w, 3). form: of `FORMS`. rate: pictures a second.

    Raises:
        OutputError: an MP4 is asked for without the extra that writes it.
    """
    if form == ".png":
        return encode(shots[-1], "PNG")
    if form == ".gif":
        return _gif(shots, rate)
    return _mp4(shots, rate)


def _gif(shots: Sequence[U8], rate: float) -> bytes:
    frames = [Image.fromarray(shot).quantize(64, dither=Image.Dither.NONE) for shot in shots]
    buffer = io.BytesIO()
    frames[0].save(
        buffer, "GIF", save_all=True, append_images=frames[1:], duration=round(1000 / rate), loop=0
    )
    return buffer.getvalue()


def _mp4(shots: Sequence[U8], rate: float) -> bytes:
    try:
        from moviepy import ImageSequenceClip
    except ImportError:
        raise OutputError("an .mp4 needs moviepy; pip install 'datmo-gym[video]', or name a .gif") from None
    even = [np.ascontiguousarray(s[: s.shape[0] // 2 * 2, : s.shape[1] // 2 * 2]) for s in shots]
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "film.mp4"
        clip = ImageSequenceClip(even, fps=rate)
        clip.write_videofile(str(path), logger=None, audio=False, codec="libx264")
        clip.close()
        return path.read_bytes()
