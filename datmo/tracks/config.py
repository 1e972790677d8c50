"""Every number the tracker is tuned by, with its unit."""

from __future__ import annotations

from typing import Literal, Self

from pydantic import BaseModel, ConfigDict, Field, PositiveFloat, model_validator


class TrackerConfig(BaseModel):
    """Tuning of the tracker; frozen, an unknown key is an error."""

    model_config = ConfigDict(frozen=True, extra="forbid")

    # Motion (method.md 9)
    models: tuple[Literal["cv", "ctrv", "rm", "ctra", "csav", "cca"], ...] = Field(
        ("cv", "ctrv", "rm"), min_length=1, description="motion models of the IMM, by name"
    )
    accel_density: float = Field(1.5, gt=0, description="white acceleration along the heading [m²/s³]")
    heading_density: float = Field(0.006, gt=0, description="random walk of a CV heading [rad²/s]")
    yaw_accel_density: float = Field(0.08, gt=0, description="white yaw acceleration of CTRV [rad²/s³]")
    jerk_density: float = Field(2.0, gt=0, description="white jerk along the heading, CTRA and CCA [m²/s⁵]")
    curvature_density: float = Field(
        0.002, gt=0, description="random walk of the curvature of CSAV and CCA [1/(m² s)]"
    )
    random_density: float = Field(1.5, gt=0, description="random walk of an RM position [m²/s]")
    cv_keeps_yaw_rate: bool = Field(False, description="CV keeps its yaw rate, as the thesis has it")

    # IMM (11)
    stay: float = Field(2.0, gt=0, description="mean time in one mode [s]")
    transition_rates: tuple[tuple[float, ...], ...] | None = Field(
        None, description="rate i -> j [1/s], rows sum to zero; replaces `stay`"
    )
    freeze_unseen: bool = Field(True, description="modes neither mix nor move while a track is unobserved")
    mix_yaw_rate: bool = Field(False, description="models without a yaw rate mix one in (textbook IMM)")

    # Measurement (8, 14)
    position_std: float = Field(
        0.15, gt=0, description="noise of a box's centre where an end may be unseen [m]"
    )
    whole_std: float = Field(0.08, gt=0, description="noise where rays show both ends to be real [m]")
    given_std: tuple[PositiveFloat, PositiveFloat] = Field(
        (0.08, 0.04), description="noise along and across boxes that come without a Sight [m]"
    )
    yaw_std: float = Field(0.06, gt=0, description="noise of a sure box yaw [rad]")
    use_yaw: bool = Field(True, description="box yaw is a third measurement, modulo pi")
    yaw_gate: float = Field(3.5, gt=0, description="a yaw further off than this is no measurement [sigma]")
    yaw_length: float = Field(2.2, ge=0, description="least box length whose yaw is sure [m]")
    yaw_ratio: float = Field(1.3, ge=1, description="least length over width whose yaw is sure")
    scores: Literal["auto", "logit", "ignored"] = Field(
        "auto",
        description="what scores are: logits of being real, nothing of the kind, or logits once one "
        "outside 0..1 is seen",
    )
    logit_half: float = Field(3.0, description="logit of a box that is as often real as not (PointRCNN)")
    logit_slope: float = Field(0.73, gt=0, description="log-odds of being real per unit of logit (PointRCNN)")
    doubt_noise: float = Field(
        2.3, ge=0, description="extra deviations of a box that is hardly real, by sqrt(1 - trust)"
    )
    least_trust: float = Field(0.2, ge=0, le=1, description="boxes less likely to be real are left out")
    birth_trust: float = Field(0.6, ge=0, le=1, description="boxes less likely to be real start no track")

    # Association (12)
    association: Literal["jpda", "pda", "gnn", "jipda"] = Field(
        "jpda",
        description="joint PDA; each track by itself; global nearest neighbour; joint PDA with existence",
    )
    gate_chi2: float = Field(13.8, gt=0, description="gate on the squared Mahalanobis distance, q = 2")
    detection_prob: float = Field(0.9, gt=0, lt=1, description="P_D of an object in full view")
    gate_prob: float = Field(0.999, gt=0, lt=1, description="P_G, probability of the gate")
    visible_floor: float = Field(0.2, gt=0, le=1, description="P_D never falls below this share of itself")
    clutter: Literal["poisson", "nonparametric"] = Field("poisson", description="form of the event weights")
    clutter_density: float = Field(0.005, gt=0, description="false boxes [1/m²], Poisson form")
    weigh_shape: bool = Field(True, description="size and heading weigh the association")
    max_frontier: int = Field(14, ge=2, le=20, description="bits of the exact association's widest cut")

    born_existence: float = Field(0.95, gt=0, le=1, description="jipda: existence of a confirmed track")
    dead_existence: float = Field(0.02, ge=1e-5, lt=1, description="jipda: existence at which a track dies")
    survival_time: float = Field(30.0, gt=0, description="jipda: mean stay of an object [s]")

    # Births and deaths (13)
    confirm_hits: int = Field(5, ge=2, le=5, description="associations that confirm a track")
    confirm_trust: float = Field(
        0.97, gt=0, le=1, description="probability that any box is real that confirms a track sooner"
    )
    birth_misses: int = Field(1, ge=0, description="misses a new track may have before confirmation")
    birth_speed_std: float = Field(10.0, gt=0, description="prior deviation of a new track's velocity [m/s]")
    claim: float = Field(0.5, gt=0, le=1, description="a box claimed less than this may start a track")
    max_missed: float = Field(0.8, gt=0, description="life without a hit where it should be seen [s]")
    empty_weight: float = Field(
        1.0, ge=0, description="how much more a miss counts where rays pass through the place"
    )
    max_hidden: float = Field(6.0, gt=0, description="life without a hit in all [s]")
    max_coast: float = Field(
        0.18, gt=0, description="life without a hit when no Sight is given [s]; one miss at the least"
    )
    max_position_std: float = Field(10.0, gt=0, description="a track less certain than this dies [m]")
    duplicate_distance: float = Field(1.0, ge=0, description="tracks nearer than this are one [m]")
    duplicate_spread: float = Field(0.3, ge=0, description="summed deviation of the difference [m]")
    recall: bool = Field(True, description="match new tracks to coasting and lost ones (second stage)")
    recall_chi2: float = Field(16.0, gt=0, description="gate of that match, six quantities")

    hold_back: bool = Field(
        True, description="who is not found where rays see is likelier behind what hides it"
    )

    # Static or dynamic (Alg. 4)
    window: float = Field(1.0, gt=0, description="time over which motion is judged [s]")
    static_speed: float = Field(0.5, gt=0, description="mean speed below which a track may be static [m/s]")

    # Box tracker (14)
    bias_std: float = Field(
        0.18,
        ge=0,
        description="error of a box's centre that stays from scan to scan, told in the covariance [m]",
    )
    unknown_side_std: float = Field(
        0.2, ge=0, description="the same per metre of a side of which both ends were never seen"
    )
    grow: float = Field(0.5, gt=0, le=1, description="gain when a box is larger than retained")
    shrink: float = Field(0.0, ge=0, le=1, description="gain when a box is smaller than retained")
    whole_gain: float = Field(0.2, ge=0, le=1, description="gain either way where both ends are real")
    correct_ends: bool = Field(True, description="move partial boxes to where the whole one is")
    expected_gain: float = Field(
        0.1, ge=0, le=1, description="gain towards the detector's size of a vehicle's side never seen whole"
    )
    unknown_end_std: float = Field(
        0.3, ge=0, description="extra deviation per metre of missing extent where no end is shown to be real"
    )
    partial_yaw: float = Field(
        2.0, ge=0, description="how many times noisier a yaw is by missing over seen length"
    )
    partial_std: float = Field(0.15, ge=0, description="extra deviation per metre of missing extent")

    @model_validator(mode="after")
    def _existence(self) -> Self:
        if self.born_existence <= self.dead_existence:
            raise ValueError(
                f"born_existence {self.born_existence} must exceed dead_existence {self.dead_existence}, "
                "or tracks die as they are confirmed"
            )
        return self

    @model_validator(mode="after")
    def _rates(self) -> Self:
        rates = self.transition_rates
        if rates is None:
            return self
        n = len(self.models)
        square = len(rates) == n and all(len(row) == n for row in rates)
        if not square or any(abs(sum(row)) > 1e-9 for row in rates):
            raise ValueError(f"transition_rates must be {n} x {n} with rows that sum to zero, got {rates}")
        if any(rates[i][j] < 0 for i in range(n) for j in range(n) if i != j):
            raise ValueError(f"transition_rates off the diagonal must not be negative, got {rates}")
        return self
