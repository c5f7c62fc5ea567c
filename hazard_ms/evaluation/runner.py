"""Plays one episode of one agent, decision by decision, and tells watchers of it."""

from __future__ import annotations

import time
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import replace
from typing import Any

from hazard_ms.agents.base import Agent, PrivilegedAgent, agent, counters_of, note_of, staying
from hazard_ms.agents.latency import OFF, frames_of, seconds_of
from hazard_ms.evaluation.averted.account import Account
from hazard_ms.evaluation.hashes import EVERY, extended
from hazard_ms.evaluation.metrics import Fate, Tally
from hazard_ms.evaluation.options import EpisodeOptions
from hazard_ms.evaluation.result import BROKEN, STUCK, DecisionRecord, EpisodeResult, Link, Played, file_hashes
from hazard_ms.evaluation.teams.fields import TEAM_FORMAT
from hazard_ms.evaluation.watchers import Watcher
from hazard_ms.sensing.detection.perception import eyes_of
from hazard_ms.skills.actions import wait
from hazard_ms.skills.context import LowLevel
from hazard_ms.skills.decision import STOP, Action, Decision, Result
from hazard_ms.skills.executor import SkillEnv
from hazard_ms.skills.team import TeamSkills
from hazard_ms.spec.registry.detectors import TRUTH

FRAME_REACHED = "frame reached"  # how a run ends if it was asked to end at a frame
RUNNING = "running"  # of an episode that has not ended
MOST_IDLE = 100  # decisions in a row after which an episode ends if no time passes [ours]


class Runner:
    """Plays episodes of one agent in one environment; by a `clock`, hazards go on while the agent thinks."""

    def __init__(self, env: SkillEnv, agent: Agent, watchers: Sequence[Watcher] = (), clock: str = OFF) -> None:
        self.env, self.agent, self.watchers, self.clock = env, agent, tuple(watchers), clock
        self._start()

    def _start(self) -> None:
        self._records: list[DecisionRecord] = []
        self._links: list[Link] = []
        self._seconds = dict.fromkeys(("build", "looks", "agent", "physics"), 0.0)

    def played(self, ended: str = RUNNING) -> Played:
        """The course of the episode up to now."""
        return Played(ended, tuple(self._records), tuple(self._links), dict(self._seconds), counters_of(self.agent))

    @contextmanager
    def _timed(self, phase: str) -> Iterator[None]:
        """Count the wall time of the block as that of `phase`, except for looks, which count separately."""
        start, looked = time.perf_counter(), self.env.look_seconds
        yield
        looks = self.env.look_seconds - looked
        self._seconds["looks"] += looks
        self._seconds[phase] += time.perf_counter() - start - looks

    def run(self, seed: int | None, options: dict[str, Any] | None = None, until_frame: int | None = None) -> Played:
        """Play an episode from its reset with `seed` and `options` to its end, or to the frame `until_frame`.

        Raises ValueError for a seed, a scene, or an action or note of the agent that is not valid, RuntimeError for an
        agent that calls sys.exit.
        """
        self._start()
        self.env.colours = self.agent.colours or any(watcher.colours for watcher in self.watchers)
        with self._timed("build"):
            decision, _ = self.env.reset(seed=seed, options=options)
        with self._timed("agent"), staying("reset of the agent"):
            if isinstance(self.agent, PrivilegedAgent):
                self.agent.attach(self.env)
            self.agent.reset(self.env.brief())
        self.env.watch, self.env.until_frame = self._frame, until_frame
        self.env.skill = self.agent.skill
        for watcher in self.watchers:
            watcher.begin(self.env, decision)
        try:
            ended = self._play(decision)
        finally:
            self.env.watch = self.env.until_frame = None
        for watcher in self.watchers:
            watcher.finish(ended)
        return self.played(ended)

    def _play(self, decision: Decision) -> str:
        """Play from the first `decision` on. Returns why the episode ended."""
        idle = 0  # decisions since time last passed: an agent whose actions take none must not go on for ever
        while idle < MOST_IDLE:
            extended(self._links, self.env)
            if self.env.until_frame is not None and self.env.frame >= self.env.until_frame:
                return FRAME_REACHED
            for watcher in self.watchers:
                watcher.asked(self.played())
            begun = time.perf_counter()
            with self._timed("agent"), staying("act of the agent"):
                action = self.agent.act(decision)
            thought = seconds_of(self.clock, self.agent.thought, time.perf_counter() - begun)
            note, value = note_of(self.agent), Tally.of(fates(self.env)).value
            for watcher in self.watchers:
                watcher.decided(decision, action, note)
            with self._timed("physics"):
                if frames := frames_of(thought, float(self.env.base.control_timestep)):
                    self.env.run(wait(self.env.stage, frames))
                waited = self.env.frame - decision.frame
                following, _, terminated, truncated, info = self.env.step(action)
            result: Result = info["result"]
            for watcher in self.watchers:
                watcher.ended(result)
            record = self._record(decision, action, result, note, value)
            self._records.append(replace(record, waited=waited, thought=thought))
            if terminated or truncated:
                extended(self._links, self.env)
                return self._reason(action, info)
            idle = idle + 1 if following.frame == decision.frame else 0
            decision = following
        return STUCK

    def _frame(self, action: LowLevel) -> None:
        if self.env.frame % EVERY == 0:
            extended(self._links, self.env)
        for watcher in self.watchers:
            watcher.frame(action)

    def _record(self, decision: Decision, action: Action, result: Result, note: str, value: float) -> DecisionRecord:
        return DecisionRecord(
            frame=decision.frame,
            verb=action.verb,
            target=action.target,
            ok=result.ok,
            reason=result.reason,
            frames=result.frames,
            note=note,
            held=decision.held,
            value=value,
            fallback=bool(self.agent.fallback),
        )

    def _reason(self, action: Action, info: dict[str, Any]) -> str:
        if bool(info["sim_error"][0]):
            return BROKEN
        if bool(info["success"][0]):
            return self.env.base.task.goal.done
        if bool(info["fail"][0]):
            return "failed"
        if action.verb == STOP:
            return self.agent.ending
        return "time" if self.env.frame >= self.env.max_frames else FRAME_REACHED


def fates(env: SkillEnv | TeamSkills) -> tuple[Fate, ...]:
    """The fates of the targets of `env`, so far."""
    world, episode, made = env.base.world, env.base.episode, []
    for row in env.base.observer.table.rows(world):
        saved = bool(episode.rescue.safe[0, row.index])
        damaged = (episode.rescue if saved else episode.damage).damaged[0, row.index]
        frame = int(episode.rescue.frame[0, row.index]) if saved else None
        struck = int(episode.damage.frame[0, row.index]) if bool(damaged) else None
        made.append(Fate(row.name, row.category, row.value, saved, bool(damaged), frame, struck))
    return tuple(made)


def play(
    options: EpisodeOptions, watchers: Sequence[Watcher] = (), player: Agent | None = None, **keywords: Any
) -> EpisodeResult:
    """Play one episode in an environment of its own, made with `keywords` of gym.make besides those of `options`.

    `player` decides in place of the agent of `options`; an Account among `watchers` adds what is lost and the loads.

    Raises ValueError for what cannot be played.
    """
    start = time.perf_counter()
    options.check()
    player = player or agent_of(options)
    env = environment(options, **keywords)
    made = time.perf_counter()
    try:
        if env.base.task.safe_place.at_rest and not any(isinstance(w, Account) for w in watchers):
            watchers = [*watchers, Account()]
        played = Runner(env, player, watchers, options.clock).run(options.seed, options.reset_options)
        result = result_of(options, env, played)
        for account in (w for w in watchers if isinstance(w, Account)):
            result = replace(result, **account.closed(lambda: fates(env)))
        played.phase_seconds["build"] += made - start
        return replace(result, wall_seconds=time.perf_counter() - start)
    finally:
        env.close()


def environment(options: EpisodeOptions, **keywords: Any) -> SkillEnv:
    """The environment of the episode of `options`, made with `keywords` of gym.make besides.

    It computes no rewards, unless `keywords` ask for them: results hold none, and they are a tenth of a frame.
    """
    return SkillEnv.make(options.env_id, options.perception, **{"reward_mode": "none", **options.settings, **keywords})


def agent_of(options: EpisodeOptions) -> Agent:
    """A new agent for the episode of `options`.

    Raises ValueError for one that cannot be found, and for a privileged one where things are not told as they are.
    """
    made = agent(options.agent)
    if isinstance(made, PrivilegedAgent) and options.perception != TRUTH:
        raise ValueError(
            f"perception must be {TRUTH} for {options.agent}, which sees what is hidden, got {options.perception!r}"
        )
    return made


def result_of(options: EpisodeOptions, env: SkillEnv | TeamSkills, played: Played) -> EpisodeResult:
    """The result of the episode of `options` as it stands in `env`, after `played`."""
    made = EpisodeResult(
        env_id=options.env_id,
        agent=options.agent,
        seed=options.seed,
        scene=env.base.specs[0].name,
        settings=options.settings,
        frames=env.frame,
        max_frames=env.max_frames,
        ended=played.ended,
        targets=fates(env),
        decisions=played.decisions,
        command=options.command,
        links=played.links,
        phase_seconds=played.phase_seconds,
        clock=options.clock,
        perception=options.perception,
        eyes=eyes_of(options.perception),
        counters=played.counters,
        files=file_hashes(options.agent, options.perception),
    )
    return replace(made, robot_collisions=env.collisions, format=TEAM_FORMAT) if isinstance(env, TeamSkills) else made


def played_to(options: EpisodeOptions, frame: int, **keywords: Any) -> SkillEnv:
    """An environment in which the episode of `options` has been played to `frame`; whoever asked for it closes it.

    `keywords` are those of gym.make besides those of `options`. Raises ValueError for what cannot be played.
    """
    player = agent_of(options)
    env = environment(options, **keywords)
    Runner(env, player, clock=options.clock).run(options.seed, options.reset_options, until_frame=frame)
    return env
