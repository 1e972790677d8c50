"""Diffuse reflectivity of materials at 905 nm, 0..1, as a lidar sees them.

Orders of magnitude, after laser scanners' data sheets and near-infrared reflectance tables: paints
scatter 0.2-0.6, rubber 0.05-0.1, cloth 0.2-0.6 whatever its colour; number plates and lamps are
retro-reflectors.

Window glass throws light on or away and scatters next to none back. Its value is the one that makes the
simulator's link budget (sim/scan/returns.py: half the returns lost where reflectance / range² is 2.3e-5 /
m²) lose as many as a real HDL-64E: of the rays at the windows of two cars at 7-8 m in KITTI's odometry
sequence 00, pillars and head rests included, 22 to 47 % come back, so of those at the panes alone about one
in five.
"""

from __future__ import annotations

PAINT = (0.55, 0.35, 0.2, 0.45)  # white, silver, dark, bright colour
GLASS = 1.4e-3
TYRE = 0.06
RIM = 0.45
UNDERBODY = 0.1
TRIM = 0.12
PLATE = 0.95
LAMP = 0.8
CARGO = 0.5
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
