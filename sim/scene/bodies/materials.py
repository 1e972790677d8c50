"""Diffuse reflectivity of materials at 905 nm, 0..1, as a lidar sees them.

Orders of magnitude, after laser scanners' data sheets and near-infrared reflectance tables: rubber 0.05-0.1,
cloth 0.2-0.6 whatever its colour; number plates are retro-reflectors. What paint scatters under its clear
coat is far less than what it mirrors away: 0.03-0.12. With it, a car seen from behind at 60 m returns about
a fifth of its rays and a white truck at 70 m most of them, as in KITTI's object sweep 000001 (9 points of
some 50, 76 of some 90), and flanks have the intensity of those in real sweeps (0.05 on average).

Window glass throws light on or away and scatters next to none back. Its value is the one that makes the
simulator's link budget (sim/scan/returns.py) lose as many as a real HDL-64E: of the rays at the windows of
two cars at 7-8 m in KITTI's odometry sequence 00, pillars and head rests included, 22 to 47 % come back, so
of those at the panes alone about one in five. They are rays of the upper block, focused far away.
"""

from __future__ import annotations

PAINT = (0.12, 0.07, 0.03, 0.09)  # white, silver, dark, bright colour
GLASS = 8e-3
TYRE = 0.06
RIM = 0.12
UNDERBODY = 0.05
TRIM = 0.06
PLATE = 0.95
LAMP = 0.3
CARGO = 0.2
STEEL = 0.3
SKIN = 0.5
HAIR = 0.2
CLOTH = (0.35, 0.55, 0.25, 0.6)
TROUSERS = (0.3, 0.2, 0.4, 0.3)
SHOE = 0.12
CONCRETE = 0.35
HELMET = 0.4
COAT = (0.3, 0.2, 0.45, 0.25)
ENGINE = 0.2
