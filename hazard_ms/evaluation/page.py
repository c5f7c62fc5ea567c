"""One episode as a web page that needs nothing else: video, score, timeline, fates, decisions, and how to run it again."""

from __future__ import annotations

import base64
import os
from pathlib import Path

import jinja2

from hazard_ms.catalogue import DAMAGED_SHARE
from hazard_ms.evaluation.result import EpisodeResult

LARGEST_EMBEDDED = 30 * 1024 * 1024  # a larger video is linked, not embedded [bytes]
COLOURS = {  # of the verbs in the timeline
    "walk_to": "#5cadff",
    "walk_one_step": "#8fc5ff",
    "pick_up": "#ffcd56",
    "drop": "#56cc82",
    "explore": "#8791a3",
    "stop": "#ef5f54",
}


def write_page(path: Path, result: EpisodeResult, video: Path | None = None) -> None:
    """Write the page of `result`; a small `video` becomes part of it, a large one is linked by its name relative to the page."""
    row = result.to_dict()
    environment = jinja2.Environment(autoescape=True, undefined=jinja2.StrictUndefined, trim_blocks=True, lstrip_blocks=True)
    page = environment.from_string(TEMPLATE).render(
        r=row,
        share=_percent(row["score"]["value"]),
        step="–" if row["score"]["step"] is None else f"{row['score']['step']:.1f}",
        damage=_percent(row["score"]["damage"]),
        saved=sum(f["rescued"] for f in row["targets"]),
        video=None if video is None else _source(video, path),
        colours=COLOURS,
        steps=_steps(result),
    )
    path.write_text(page, encoding="utf-8")


def _percent(share: float | None) -> str:
    return "–" if share is None else f"{100 * share:.1f} %"


def _source(video: Path, page: Path) -> str:
    if video.stat().st_size <= LARGEST_EMBEDDED:
        return "data:video/mp4;base64," + base64.b64encode(video.read_bytes()).decode("ascii")
    return Path(os.path.relpath(video.resolve(), page.resolve().parent)).as_posix()


def _steps(result: EpisodeResult) -> str:
    """The curve of value rescued over frames as the points of an SVG line, in a box of 1000 x 100."""
    end = max(1, result.max_frames)
    total = sum(f.value for f in result.targets)
    points, level = [(0.0, 100.0)], 0.0
    for fate in sorted((f for f in result.targets if f.frame is not None), key=lambda f: f.frame or 0):
        x = 1000.0 * (fate.frame or 0) / end
        points.append((x, 100.0 - 100.0 * level))
        level += fate.value * (DAMAGED_SHARE if fate.damaged else 1.0) / total
        points.append((x, 100.0 - 100.0 * level))
    points.append((1000.0 * result.frames / end, 100.0 - 100.0 * level))
    return " ".join(f"{x:.1f},{y:.1f}" for x, y in points)


TEMPLATE = """<!doctype html>
<html lang="en"><head><meta charset="utf-8"><meta name="viewport" content="width=device-width, initial-scale=1">
<title>{{ r.env_id }} {{ r.scene }}: {{ r.agent }}, seed {{ r.seed }}</title>
<style>
:root { --night: #0f1115; --panel: #181b21; --edge: #2c313a; --text: #eceff4; --soft: #949dab; --accent: #ff8a3d; --good: #56cc82;
 --bad: #ef5f54; --gold: #ffcd56 }
* { box-sizing: border-box } body { margin: 0 auto; max-width: 1180px; padding: 28px 20px 60px; background: var(--night);
 color: var(--text); font: 15px/1.5 system-ui, sans-serif }
h1 { font-size: 26px; margin: 0 } h2 { font-size: 17px; margin: 34px 0 10px } .soft { color: var(--soft) }
video { width: 100%; border-radius: 12px; background: #000; margin-top: 18px; display: block }
.cards { display: grid; grid-template-columns: repeat(auto-fit, minmax(150px, 1fr)); gap: 12px; margin-top: 18px }
.card { background: var(--panel); border: 1px solid var(--edge); border-radius: 12px; padding: 12px 16px }
.card b { display: block; font-size: 28px; font-weight: 600; line-height: 1.3 }
table { width: 100%; border-collapse: collapse }
td, th { text-align: left; padding: 6px 10px; border-bottom: 1px solid var(--edge) }
th { color: var(--soft); font-weight: 500 } td.n, th.n { text-align: right; font-variant-numeric: tabular-nums }
.wide { overflow-x: auto; background: var(--panel); border: 1px solid var(--edge); border-radius: 12px }
.good { color: var(--good) } .bad { color: var(--bad) } .gold { color: var(--gold) }
pre { background: var(--panel); border: 1px solid var(--edge); border-radius: 12px; padding: 12px 16px; overflow-x: auto }
.key { display: inline-block; margin-right: 16px } .key i { display: inline-block; width: 11px; height: 11px; border-radius: 3px;
 margin-right: 6px }
svg { width: 100%; display: block; background: var(--panel); border: 1px solid var(--edge); border-radius: 12px }
</style></head><body>
<h1>{{ r.env_id }}</h1>
<div class="soft">scene {{ r.scene }}, agent {{ r.agent }}, seed {{ r.seed }}; ended: {{ r.ended }}</div>
{% if video %}<video controls muted playsinline src="{{ video }}"></video>{% endif %}
<div class="cards">
<div class="card"><b class="good">{{ share }}</b><span class="soft">Value rescued</span></div>
<div class="card"><b>{{ saved }} of {{ r.targets | length }}</b><span class="soft">targets rescued</span></div>
<div class="card"><b>{{ step }}</b><span class="soft">Step: frames per rescue</span></div>
<div class="card"><b>{{ damage }}</b><span class="soft">Damage: of those rescued</span></div>
<div class="card"><b>{{ r.frames }}</b><span class="soft">of {{ r.max_frames }} frames</span></div>
</div>
<h2>Timeline</h2>
<svg viewBox="-20 -14 1040 166" role="img" aria-label="Decisions and value rescued over frames">
{% for d in r.decisions %}<rect x="{{ '%.1f' % (1000 * d.frame / r.max_frames) }}" y="112" height="26" rx="2"
 width="{{ '%.1f' % ([1.5, 1000 * d.frames / r.max_frames - 0.8] | max) }}"
 fill="{{ colours[d.verb] }}" opacity="{{ 1 if d.ok else 0.4 }}">
<title>frame {{ d.frame }}: {{ d.verb }} {{ d.target or '' }}{% if not d.ok %} failed: {{ d.reason }}{% endif %}</title></rect>
{% endfor %}<line x1="0" y1="100" x2="1000" y2="100" stroke="#2c313a"/><line x1="0" y1="0" x2="1000" y2="0" stroke="#2c313a"/>
<text x="1000" y="-3" fill="#949dab" font-size="11" text-anchor="end">100 % of the value</text>
<polyline points="{{ steps }}" fill="none" stroke="#56cc82" stroke-width="2.5"/></svg>
<p>{% for verb, colour in colours.items() %}<span class="key soft"><i style="background: {{ colour }}"></i>
{{- verb.replace('_', ' ') }}</span>{% endfor %}<span class="soft">faded: failed</span></p>
<h2>Targets</h2>
<div class="wide"><table><tr><th>target</th><th>category</th><th class="n">value</th><th>fate</th><th class="n">frame</th></tr>
{% for t in r.targets %}<tr><td>{{ t.name }}</td><td>{{ t.category.replace('_', ' ') }}</td>
<td class="n {{ 'gold' if t.value > 1 }}">{{ '%g' % t.value }}</td>
<td class="{{ 'good' if t.rescued and not t.damaged else 'bad' if t.damaged else 'soft' }}">
{{- 'rescued' if t.rescued else 'left behind' }}{{ ', damaged' if t.damaged }}</td>
<td class="n">{{ t.frame if t.frame is not none else '' }}</td></tr>
{% endfor %}</table></div>
<h2>Decisions</h2>
<div class="wide"><table><tr><th class="n">frame</th><th>action</th><th>why</th><th>result</th><th class="n">frames</th>
<th class="n">value</th></tr>
{% for d in r.decisions %}<tr><td class="n">{{ d.frame }}</td><td>{{ d.verb.replace('_', ' ') }} {{ d.target or '' }}</td>
<td class="soft">{{ d.note }}</td>
<td class="{{ 'good' if d.ok else 'bad' }}">{{ 'done' if d.ok else d.reason.replace('_', ' ') }}</td>
<td class="n">{{ d.frames }}</td><td class="n">{{ '%.0f %%' % (100 * d.value) }}</td></tr>
{% endfor %}</table></div>
<h2>Run it again</h2>
<pre>{{ r.command }}</pre>
<div class="wide"><table>
{% for name, value in r.versions.items() %}<tr><td>{{ name }}</td><td>{{ value }}</td></tr>
{% endfor %}
{% for name, value in r.machine.items() %}<tr><td>{{ name }}</td><td>{{ value if value is not none else 'none' }}</td></tr>
{% endfor %}{% for name, value in r.settings.items() %}<tr><td>{{ name }}</td><td>{{ value }}</td></tr>
{% endfor %}<tr><td>wall time</td><td>{{ '%.1f s' % r.wall_seconds }}</td></tr></table></div>
</body></html>
"""
