"""The page of a report: plain HTML, nothing fetched from anywhere."""

from __future__ import annotations

from string import Template

PAGE = Template("""<!doctype html>
<html lang="en">
<meta charset="utf-8">
<meta name="viewport" content="width=device-width, initial-scale=1">
<title>$title</title>
<style>
:root { --ink: #1c1f24; --faint: #6b717c; --line: #e3e5e9; --good: #23744a; --bad: #b3261e; }
* { box-sizing: border-box; }
body { margin: 0 auto; padding: 3rem 1.5rem 5rem; max-width: 62rem; color: var(--ink);
  font: 16px/1.55 "Iowan Old Style", "Palatino Linotype", Palatino, Georgia, serif; }
h1 { font-size: 2.1rem; line-height: 1.15; margin: 0 0 .3rem; font-weight: 600; }
h2 { font-size: 1.2rem; margin: 3rem 0 .6rem; font-weight: 600; }
p { margin: .4rem 0 .8rem; max-width: 46rem; }
.faint, figcaption, .meta { color: var(--faint); font-size: .88rem; }
.meta span { white-space: nowrap; margin-right: 1.3rem; }
.verdict { margin: 1.4rem 0; padding: .7rem 1rem; border-left: 4px solid var(--line); background: #f7f8f9; }
.verdict.good { border-color: var(--good); } .verdict.bad { border-color: var(--bad); }
.good b, td.good { color: var(--good); } .bad b, td.bad { color: var(--bad); }
code { font: .86em/1.4 ui-monospace, "SF Mono", Menlo, Consolas, monospace; }
pre { background: #f7f8f9; padding: .7rem 1rem; overflow-x: auto; margin: .6rem 0; }
figure { margin: .8rem 0 0; }
figure img { width: 100%; height: auto; display: block; }
figcaption { margin-top: .5rem; max-width: 50rem; }
.scene { display: grid; grid-template-columns: minmax(0, 44rem) 13rem; gap: 1.4rem; align-items: start; }
.scene img { border-radius: 4px; background: #0f1115; }
.legend { list-style: none; margin: 0; padding: 0; font-size: .85rem; color: var(--faint); }
.legend li { display: flex; align-items: center; gap: .55rem; margin: .16rem 0; }
.legend i { width: 1rem; height: .62rem; display: inline-block; border-radius: 1px; flex: none; }
.legend i.box { background: #0f1115 !important; border: 2px solid; border-radius: 0; }
.player { display: flex; align-items: center; gap: .8rem; margin-top: .6rem; }
.player input { flex: 1; accent-color: var(--ink); }
.player button { font: inherit; font-size: .85rem; width: 4.4rem; padding: .15rem 0;
  border: 1px solid var(--line);
  background: white; border-radius: 3px; cursor: pointer; }
.player output { font-variant-numeric: tabular-nums; width: 4.4rem; text-align: right; font-size: .9rem; }
table { border-collapse: collapse; font-size: .92rem; width: 100%; max-width: 50rem; }
th { text-align: left; font-weight: 600; border-bottom: 1px solid var(--ink); }
th { padding: .25rem .8rem .25rem 0; }
td { padding: .18rem .8rem .18rem 0; border-bottom: 1px solid var(--line); }
td.number, th.number { text-align: right; font-variant-numeric: tabular-nums; }
tr.group td { border: 0; padding-top: 1rem; font-weight: 600; }
@media (max-width: 50rem) { .scene { grid-template-columns: 1fr; } }
@media print { .player { display: none; } }
</style>
<h1>$title</h1>
<p>$summary</p>
<p class="meta">$meta</p>
<div class="verdict $verdict_class">$verdict</div>
<h2>Seen from above</h2>
<figure>
<div class="scene">
<div><img id="picture" src="$first" width="800" height="800" alt="bird's-eye view">
<div class="player"><button id="play">play</button>
<input id="slider" type="range" min="0" max="$last" value="0" aria-label="frame">
<output id="clock"></output></div></div>
<ul class="legend">$legend</ul>
</div>
<figcaption>Forward is up, rings every 10 m. Cloud by class, true boxes, detections, confirmed tracks with
their tails, headings and ids.</figcaption>
</figure>
<h2>Each object through time</h2>
<figure><img src="$timeline" alt="timeline of each object">
<figcaption>Lower band: how much of the object the sensor sees, exact by casting. Upper band: the track on it,
coloured and numbered by its id; a change of colour is a change of id, a gap a time without a
track.</figcaption>
</figure>
<h2>Error of the ground's height</h2>
<figure><img src="$height_error" alt="map of ground-height error">
<figcaption>Mean over the run at the returns within 50 m, cells of 1 m: blue is too low, red too high, grey
never seen.</figcaption></figure>
<h2>Time of each stage</h2>
<figure><img src="$stage_times" alt="times of the stages"></figure>
<h2>Metrics</h2>
<table><thead><tr><th>metric</th><th class="number">value</th>
<th>unit</th><th>expected</th><th></th></tr></thead>
<tbody>$rows</tbody></table>
<p class="faint">“-” is a metric with nothing to measure; it meets no expectation.</p>
<h2>Play it again</h2>
<pre><code>$replay</code></pre>
<p class="meta">$versions</p>
<script>
const frames = $frames, stamps = $stamps;
const picture = document.getElementById("picture"), slider = document.getElementById("slider");
const clock = document.getElementById("clock"), play = document.getElementById("play");
let timer = null;
function show(k) {
  slider.value = k;
  picture.src = frames[k];
  clock.textContent = stamps[k].toFixed(1) + " s";
}
function stop() { clearInterval(timer); timer = null; play.textContent = "play"; }
slider.addEventListener("input", () => { stop(); show(+slider.value); });
play.addEventListener("click", () => {
  if (timer) return stop();
  play.textContent = "pause";
  timer = setInterval(() => show((+slider.value + 1) % frames.length), $pause);
});
show($start);
</script>
</html>
""")
