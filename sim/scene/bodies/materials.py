"""Diffuse reflectivity of materials at 905 nm, 0..1, as a lidar sees them.

Orders of magnitude, after laser scanners' data sheets and near-infrared reflectance tables: paints
scatter 0.2-0.6, rubber 0.05-0.1, cloth 0.2-0.6 whatever its colour; window glass returns next to
nothing; number plates and lamps are retro-reflectors.
"""

from __future__ import annotations

PAINT = (0.55, 0.35, 0.2, 0.45)  # white, silver, dark, bright colour
GLASS = 0.0002
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
