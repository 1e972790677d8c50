"""The report of a run as one self-contained HTML page."""

from __future__ import annotations

import json
from base64 import b64encode
from collections.abc import Mapping
from html import escape
from typing import Any

import numpy as np

from datmo.messages import Kind
from eval.report.recording import Recording
from eval.report.template import PAGE
from eval.verdict import Verdict, judge, say_value
from sim.picture import palette

LEGEND: tuple[tuple[str, palette.Colour, str], ...] = (
    ("car", palette.KIND[Kind.CAR], ""),
    ("van", palette.KIND[Kind.VAN], ""),
    ("truck", palette.KIND[Kind.TRUCK], ""),
    ("pedestrian", palette.KIND[Kind.PEDESTRIAN], ""),
    ("other thing", palette.KIND[Kind.THING], ""),
    ("ground, lighter is higher", (124, 112, 94), ""),
    ("object called ground", palette.LEAKED, ""),
    ("ground called object", palette.RAISED, ""),
    ("true box (dashed: hidden)", palette.TRUE_BOX, "box"),
    ("detection", palette.DETECTION, "box"),
    ("track, by id (dashed: drifting)", palette.track_colour(1), "box"),
    ("ego", palette.EGO, "box"),
)


def page(recording: Recording, figures: Mapping[str, bytes], replay: str, facts: Mapping[str, Any]) -> str:
    """The HTML text of the report.

    Args:
        recording: a finished run.
        figures: PNG files by name: timeline, height_error, stage_times.
        replay: the command that plays the run again.
        facts: "versions" and "hardware", as written to metrics.json.
    """
    scenario = recording.scenario
    verdicts = judge(scenario.expect, recording.metrics, recording.whole)
    kind, sentence = say_verdict(verdicts)
    stamps = [stamp for stamp, _ in recording.pictures]
    pause = 1000 * float(np.median(np.diff(stamps))) if len(stamps) > 1 else 1000.0
    frames = [_inline(data, "jpeg") for _, data in recording.pictures]
    middle = len(frames) // 2
    return PAGE.substitute(
        title=escape(scenario.name),
        summary=escape(scenario.summary),
        meta=_spans(_meta(recording)),
        verdict=sentence,
        verdict_class=kind,
        first=frames[middle],
        start=middle,
        last=len(frames) - 1,
        legend="".join(_swatch(*entry) for entry in LEGEND),
        timeline=_inline(figures["timeline"], "png"),
        height_error=_inline(figures["height_error"], "png"),
        stage_times=_inline(figures["stage_times"], "png"),
        rows=_rows(recording, verdicts),
        replay=escape(replay),
        versions=_spans([f"{k} {v}" for group in facts.values() for k, v in group.items()]),
        frames=json.dumps(frames),
        stamps=json.dumps([round(s, 4) for s in stamps]),
        pause=round(pause),
    )


def say_verdict(verdicts: list[Verdict]) -> tuple[str, str]:
    """Class ("good", "bad" or "") and one sentence in HTML."""
    if not verdicts:
        return "", "The scenario expects nothing."
    failed = [v for v in verdicts if v.failed]
    waiting = sum(v.open for v in verdicts)
    if not failed and waiting:
        return "", f"{len(verdicts) - waiting} expectations are met, {waiting} open: the run was cut short."
    if not failed:
        return "good", f"<b>All {len(verdicts)} expectations are met.</b>"
    what = "; ".join(f"{escape(v.name)} is {say_value(v.value)}, expected {escape(v.bound)}" for v in failed)
    return "bad", f"<b>{len(failed)} of {len(verdicts)} expectations are not met:</b> {what}."


def _meta(recording: Recording) -> list[str]:
    moments = recording.moments
    facts = [f"seed {recording.seed}", f"{len(moments)} scans", f"{moments[-1].stamp:.1f} s"]
    facts.append(f"sensor {recording.scenario.sensor.unit}")
    if recording.ground:
        facts.append(f"ground {recording.ground}")
    return facts


def _rows(recording: Recording, verdicts: list[Verdict]) -> str:
    held = {v.name: v for v in verdicts}
    rows, group = [], ""
    for metric in recording.metrics:
        prefix, _, rest = metric.name.partition(".")
        if prefix != group:
            group = prefix
            rows.append(f'<tr class="group"><td colspan="5">{escape(group)}</td></tr>')
        verdict = held.get(metric.name)
        bound = escape(verdict.bound) if verdict else ""
        mark = "" if verdict is None else verdict.word
        kind = "" if verdict is None else ("good" if verdict.met else "bad" if verdict.failed else "")
        unit = "" if metric.unit == "1" else escape(metric.unit)
        rows.append(
            f"<tr><td>{escape(rest)}</td>"
            f'<td class="number">{say_value(metric.value)}</td><td>{unit}</td><td>{bound}</td>'
            f'<td class="{kind}">{mark}</td></tr>'
        )
    return "\n".join(rows)


def _swatch(label: str, colour: palette.Colour, kind: str) -> str:
    rgb = f"rgb{colour}"
    return f'<li><i class="{kind}" style="background:{rgb};border-color:{rgb}"></i>{escape(label)}</li>'


def _spans(items: list[str]) -> str:
    return "".join(f"<span>{escape(item)}</span> " for item in items)


def _inline(data: bytes, form: str) -> str:
    return f"data:image/{form};base64,{b64encode(data).decode()}"
