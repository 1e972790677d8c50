"""The colours of pictures and figures, one meaning each."""

from __future__ import annotations

from colorsys import hsv_to_rgb

import numpy as np

from datmo.arrays import F64, U8, Bool
from datmo.messages import Kind

Colour = tuple[int, int, int]
RAMP = 64
REST = 64  # the first code of the clusters, where all that is not ground has one colour
GOLDEN = 0.61803398875

KIND: dict[Kind, Colour] = {
    Kind.UNKNOWN: (150, 152, 160),
    Kind.CAR: (84, 158, 255),
    Kind.VAN: (64, 196, 220),
    Kind.TRUCK: (166, 128, 255),
    Kind.BUS: (198, 120, 240),
    Kind.MOTORCYCLE: (255, 150, 60),
    Kind.BICYCLE: (255, 190, 70),
    Kind.PEDESTRIAN: (255, 96, 120),
    Kind.VEGETATION: (70, 150, 80),
    Kind.TRUNK: (120, 110, 60),
    Kind.BUILDING: (130, 130, 150),
    Kind.WALL: (140, 130, 130),
    Kind.POLE: (190, 190, 150),
    Kind.SIGN: (230, 220, 120),
    Kind.THING: (150, 150, 160),
    Kind.FALSE_RETURN: (120, 60, 120),
}
LEAKED: Colour = (255, 40, 200)
RAISED: Colour = (196, 108, 40)
TRUE_BOX: Colour = (240, 240, 240)
HIDDEN_BOX: Colour = (150, 150, 150)
DETECTION: Colour = (240, 220, 100)
EGO: Colour = (120, 230, 150)
RING: Colour = (52, 57, 66)

_LOW, _MIDDLE, _HIGH = (56, 50, 46), (104, 95, 84), (164, 146, 118)


def point_table() -> U8:
    """Colours (256, 3) of point codes: kinds 0-31, leaked 32, raised 33, clusters 64-127,
    ground by height 128-191."""
    table = np.zeros((256, 3), np.uint8)
    table[:32] = KIND[Kind.UNKNOWN]
    for kind, colour in KIND.items():
        table[kind] = colour
    table[32], table[33] = LEAKED, RAISED
    table[64:128] = [track_colour(i, 0.55) for i in range(64)]
    stops = np.array([_LOW, _MIDDLE, _HIGH], float)
    share = np.linspace(0, 1, RAMP)
    for channel in range(3):
        table[128:192, channel] = np.interp(share, [0, 0.5, 1], stops[:, channel])
    return table


def track_colour(identity: int, saturation: float = 0.72) -> Colour:
    """A bright colour of an id; neighbouring ids lie far apart in hue."""
    r, g, b = hsv_to_rgb((0.07 + GOLDEN * identity) % 1.0, saturation, 1.0)
    return int(r * 255), int(g * 255), int(b * 255)


def point_codes(
    is_ground: Bool, height: F64, label: U8 | None, kind: U8 | None, truly_ground: Bool | None
) -> U8:
    """Row (n,) of `point_table` for each point.

    Args:
        is_ground: (n,) what perception says.
        height: (n,) above the ground under the ego [m, along gravity].
        label: (n,) cluster code where no truth is known.
        kind: (n,) true kind. truly_ground: (n,).
    """
    ramp = 128 + np.clip((height + 4.0) * (RAMP / 8.0), 0, RAMP - 1).astype(np.uint8)
    if kind is None or truly_ground is None:
        other = np.zeros(len(is_ground), np.uint8) if label is None else label
        return np.where(is_ground, ramp, other).astype(np.uint8)
    other = np.where(truly_ground, np.uint8(33), kind)
    called_ground = np.where(truly_ground, ramp, np.uint8(32))
    return np.where(is_ground, called_ground, other).astype(np.uint8)
