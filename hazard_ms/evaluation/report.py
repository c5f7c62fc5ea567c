"""The tables of `hazard-ms evaluate`: scores with their intervals, how episodes ended, and which actions failed why."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence

from hazard_ms.agents.latency import OFF
from hazard_ms.evaluation.averted.loss import averted_of_all, mean_loads, mean_score
from hazard_ms.evaluation.choices import LOOKS
from hazard_ms.evaluation.metrics import Score, scores
from hazard_ms.evaluation.options import SweepOptions
from hazard_ms.evaluation.result import EpisodeResult, machine, versions
from hazard_ms.skills.failures import UNFINISHED
from hazard_ms.spec import Goal
from hazard_ms.spec.registry.detectors import TRUTH

MOST_FALLBACKS = 0.05  # share of a model's decisions taken in its place, beyond which its scores are marked [ours]
HEADINGS = f"{'agent':16s} {'Value':>22s} {'Step':>26s} {'Damage':>22s} {'rescued':>8s} {'s/episode':>10s}"


def summary(result: EpisodeResult, goal: Goal) -> str:
    """The line that says how an episode of a task with this `goal` went."""
    saved = sum(fate.rescued for fate in result.targets)
    how, value = f"rescued {saved} of {len(result.targets)} targets", f"{100 * result.tally.value:.1f} % of the value, "
    if goal.verb:
        how, value = "succeeded" if result.ended == goal.done else "failed", ""
    when = f"{value}in {result.frames} frames ({result.ended})"
    return f"{result.agent} {how} in {result.scene}, {when}; {result.wall_seconds:.1f} s"


def report(options: SweepOptions, results: Sequence[EpisodeResult], failed: Sequence[str] = ()) -> str:
    """The table of the `results` of the episodes of `options`, with versions and machine.

    `failed`: the agent of each episode that has no result.
    """
    own = {agent: [r for r in results if r.agent == agent] for agent in options.agents}
    lines = [title(options), HEADINGS, *(score_line(agent, made) for agent, made in own.items())]
    lines += [success_line(agent, made, options.env.goal) for agent, made in own.items() if options.env.goal.verb]
    lines += [failure_line(agent, made, list(failed).count(agent)) for agent, made in own.items()]
    lines += [
        line
        for tell in (team_line, averted_line, model_line)
        for agent, made in own.items()
        if (line := tell(agent, made))
    ]
    return "\n".join([*lines, machine_line()])


def title(options: SweepOptions) -> str:
    """The line that says what was played."""
    env = options.env
    physics = " ".join([env.physics, *env.strength])
    robots = f"robots {' and '.join(env.robot_uids)}" if env.team else f"robot {env.robot_uids}"
    settings = [f"split {env.split}", f"physics {physics}", robots]
    settings += ["agent affected"] * env.affects_agent
    settings += [f"{name} {env.settings[name]}" for name in LOOKS if name in env.settings]
    settings += [] if options.clock == OFF else [f"clock {options.clock}"]
    settings += [] if options.perception == TRUTH else [f"perception {options.perception}"]
    what = ", ".join([env.env_id, *env.hazards, *settings])
    return f"{what}, {options.count} episodes each, seeds from {options.seed}"


def score_line(agent: str, results: Sequence[EpisodeResult]) -> str:
    """The scores of one agent, Value and Damage in per cent, Step in frames."""
    if not results:
        return f"{agent:16s} no results"
    found = scores([r.tally for r in results], [r.scene for r in results])
    saved = sum(r.tally.rescued for r in results)
    targets = sum(len(r.targets) for r in results)
    seconds = sum(r.wall_seconds for r in results) / len(results)
    value, step, damage = (_shown(found[name], 1 if name == "step" else 100) for name in ("value", "step", "damage"))
    return f"{agent:16s} {value:>22s} {step:>26s} {damage:>22s} {saved:4d}/{targets:<4d} {seconds:9.1f}"


def success_line(agent: str, results: Sequence[EpisodeResult], goal: Goal) -> str:
    """The line that counts how often an agent reached a `goal` of which one action is enough."""
    return f"{agent}: succeeded in {sum(r.ended == goal.done for r in results)} of {len(results)} episodes"


def failure_line(agent: str, results: Sequence[EpisodeResult], failed: int = 0) -> str:
    """The line that counts how an agent's episodes ended, and which of its actions were unfinished or failed, and why.

    `failed`: its episodes without a result.
    """
    ends = Counter(r.ended for r in results)
    ends += Counter({"error": failed})
    left = [d for r in results for d in r.decisions if not d.ok]
    unfinished = Counter(d.verb for d in left if d.reason in UNFINISHED)
    failures = Counter(f"{d.verb} {d.reason}" for d in left if d.reason not in UNFINISHED)
    under_way = f"unfinished: {_counted(unfinished)}; " if unfinished else ""
    return f"{agent}: ended by {_counted(ends)}; {under_way}failures: {_counted(failures) or 'none'}"


def team_line(agent: str, results: Sequence[EpisodeResult]) -> str:
    """The line that counts how often the robots of a team collided; empty for a single robot."""
    told = [r.robot_collisions for r in results if r.robot_collisions is not None]
    return f"{agent}: {sum(told)} collisions of robots with one another in {len(told)} episodes" if told else ""


def averted_line(agent: str, results: Sequence[EpisodeResult]) -> str:
    """The line that says what an agent averted, in per cent, and what its robot bore; empty where nobody asked."""
    told = [r for r in results if r.lost is not None]
    if not told:
        return ""
    scenes = [r.scene for r in told]
    targets, things = [r.averted for r in told], [averted_of_all(r.lost, r.lost_alone) for r in told]
    parts = [
        f"averted {_shown(mean_score(targets, scenes), 100)} of the targets' value that is lost if nobody acts",
        f"{_shown(mean_score(things, scenes), 100)} of that of all things",
    ]
    parts += [f"undefined in {undefined} of {len(told)} episodes"] if (undefined := targets.count(None)) else []
    loads = mean_loads([r.loads for r in told])
    shown = {"heat": "dose of heat {:.3f}", "wading": "{:.1f} s in water", "water": "{:.2f} m s of it"}
    shown["collisions"] = "{:.1f} collisions"
    borne = [words.format(loads[name]) for name, words in shown.items() if name in loads]
    return f"{agent}: {', '.join(parts)}" + (f"; the robot: {', '.join(borne)} an episode" if borne else "")


def model_line(agent: str, results: Sequence[EpisodeResult]) -> str:
    """The line that says what a language model was asked, and how long agents thought; empty where neither counts.

    Scores to which other rules contributed much are marked.
    """
    counted: Counter[str] = Counter()
    for result in results:
        counted.update(result.counters)
    parts = []
    if asked := counted["decisions"]:
        share = counted["fallbacks"] / asked
        mark = ": NOT THE MODEL'S OWN SCORE" if share > MOST_FALLBACKS else ""
        parts.append(f"asked for {asked:.0f} decisions, {100 * share:.1f} % of them taken in its place{mark}")
        parts.append(f"{counted['calls']:.0f} calls, {counted['lost']:.0f} without an answer")
        parts.append(f"{counted['tokens_in']:.0f} tokens read, {counted['tokens_out']:.0f} written")
        parts += [f"{counted['cost']:.2f} USD"] if counted["cost"] else []
    decisions = [d for r in results if r.clock != OFF for d in r.decisions]
    if frames := sum(d.waited + d.frames for d in decisions):
        thought = sum(d.thought for d in decisions) / len(decisions)
        parts.append(
            f"{thought:.2f} s a decision, {100 * sum(d.waited for d in decisions) / frames:.1f} % of the frames"
        )
    return f"{agent}: {'; '.join(parts)}" if parts else ""


def machine_line() -> str:
    """Versions and machine in one line."""
    return ", ".join(f"{name} {value}" for name, value in {**versions(), **machine()}.items())


def _shown(score: Score, factor: float = 1.0) -> str:
    if score.mean is None or score.low is None or score.high is None:
        return "-"
    return f"{factor * score.mean:.1f} [{factor * score.low:.1f}, {factor * score.high:.1f}]"


def _counted(counter: Counter[str]) -> str:
    return ", ".join(f"{n} {what}" for what, n in counter.most_common())
