"""Vehicles driven by highway-env, and the ego among them."""

from __future__ import annotations

from typing import Any, Literal

from pydantic import Field

from scenarios.spec.base import Model


class Traffic(Model):
    """Vehicles driven by highway-env."""

    environment: str | None = Field("intersection-v1", description="a highway-env id, or null for none")
    vehicles: int = Field(10, ge=0, le=100, description="vehicles kept within range, the ego not counted")
    warm_up: float = Field(3.0, ge=0, le=60, description="played before the first scan [s]")
    config: dict[str, Any] = Field(default_factory=dict, description="highway-env's own config keys")


class Ego(Model):
    """The vehicle that carries the sensor."""

    control: Literal["autopilot", "agent", "parked"] = "autopilot"
    speed: float = Field(8.0, ge=0, le=40, description="the autopilot's cruise [m/s]")
    start: float | None = Field(
        None,
        ge=0,
        le=10_000,
        description="at the first scan, ahead of its first lane's end [m]; null: anywhere",
    )
