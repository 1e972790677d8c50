"""Real sweeps beside simulated ones, statistic by statistic."""

from eval.compare import show
from eval.compare.judge import Line, judge
from eval.compare.profile import Profile, mean, profile

__all__ = ["Line", "Profile", "judge", "mean", "profile", "show"]
