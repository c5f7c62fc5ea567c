"""`hazard-ms play`: one episode of one agent, with its video, its result as JSON, and its page."""

from __future__ import annotations

import os
import sys
import time
from contextlib import ExitStack
from dataclasses import dataclass, field
from typing import Any

import gymnasium as gym
from tqdm import tqdm

import hazard_ms  # noqa: F401 registers the environments
from hazard_ms.agents.base import Agent, agent
from hazard_ms.evaluation.filming import Film, fates
from hazard_ms.evaluation.metrics import Tally
from hazard_ms.evaluation.page import write_page
from hazard_ms.evaluation.result import DecisionRecord, EpisodeResult
from hazard_ms.evaluation.video import RENDERED, Video
from hazard_ms.order import Order
from hazard_ms.skills.decision import STOP, Action, Decision, Result
from hazard_ms.skills.executor import SkillEnv

FILM_RATE = 24.0  # pictures per second


@dataclass
class Episode:
    """An episode as it is played, decision by decision."""

    env: SkillEnv
    player: Agent
    film: Film | None = None
    records: list[DecisionRecord] = field(default_factory=list)

    def run(self, decision: Decision) -> str:
        """Play from the first `decision` on. Returns why the episode ended."""
        while len(self.records) <= self.env.max_frames:  # an agent whose actions take no time must not go on for ever
            action = self.player.act(decision)
            value = Tally.of(fates(self.env.base)).value
            if self.film is not None:
                self.film.decided(decision, action, self.player.note)
            following, _, terminated, truncated, info = self.env.step(action)
            self._note(decision, action, info["result"], value)
            if terminated or truncated:
                return self._reason(action, info)
            decision = following
        return "too many decisions"

    def _note(self, decision: Decision, action: Action, result: Result, value: float) -> None:
        if self.film is not None:
            self.film.ended(result)
        self.records.append(
            DecisionRecord(
                decision.frame,
                action.verb,
                action.target,
                result.ok,
                result.reason,
                result.frames,
                self.player.note,
                decision.held,
                value,
            )
        )

    def _reason(self, action: Action, info: dict[str, Any]) -> str:
        if bool(info["sim_error"][0]):
            return "simulation error"
        if bool(info["success"][0]):
            return "all rescued"
        return "stopped" if action.verb == STOP else "time"


def play(order: Order, quiet: bool = False) -> EpisodeResult:
    """Play one episode, and write what the order asks for. A progress bar goes to stderr unless `quiet`."""
    order.check()
    player = agent(order.agent)
    looks: dict[str, Any] = {}
    if order.video is not None:
        looks = {"render_mode": "rgb_array", "human_render_camera_configs": {"width": RENDERED[0], "height": RENDERED[1]}}
    with ExitStack() as stack:
        made = gym.make(order.env_id, obs_mode="none", **order.settings, **looks)
        stack.callback(made.close)
        result = _episode(order, SkillEnv(made), player, stack, quiet)
    if order.video is not None:
        result.write(order.video.with_suffix(".json"))
        write_page(order.video.with_suffix(".html"), result, order.video)
    return result


def _episode(order: Order, env: SkillEnv, player: Agent, stack: ExitStack, quiet: bool) -> EpisodeResult:
    start = time.perf_counter()
    decision, _ = env.reset(seed=order.seed, options={} if order.scene is None else {"scene": order.scene})
    player.reset(env.base.task, order.seed)
    scene = env.base.specs[0].name
    bar = stack.enter_context(
        tqdm(
            total=env.max_frames,
            unit="frame",
            desc=f"{order.agent} in {scene}",
            disable=quiet,
            mininterval=0.1 if sys.stderr.isatty() else 5.0,
        )
    )
    film = None
    if order.video is not None:
        video = stack.enter_context(Video(order.video, FILM_RATE))
        speed = order.every * FILM_RATE * env.base.control_timestep
        subtitle = f"agent {order.agent}, seed {order.seed}, {order.physics} physics, {speed:g}x speed"
        film = Film(env, video, f"{order.env_id}   {scene}", subtitle, order.every)

    def watch(action: Any) -> None:
        bar.update()
        if film is not None:
            film.watch(action)

    env.watch = watch
    episode = Episode(env, player, film)
    ended = episode.run(decision)
    if film is not None:
        film.close()
    return EpisodeResult(
        env_id=order.env_id,
        agent=order.agent,
        seed=order.seed,
        scene=scene,
        settings=order.settings,
        frames=env.frame,
        max_frames=env.max_frames,
        ended=ended,
        targets=fates(env.base),
        decisions=tuple(episode.records),
        command=order.command,
        wall_seconds=time.perf_counter() - start,
    )


def summary(result: EpisodeResult) -> str:
    """What the command prints."""
    saved = sum(f.rescued for f in result.targets)
    share = f"{100 * result.tally.value:.1f} % of the value"
    return (
        f"{result.agent} rescued {saved} of {len(result.targets)} targets in {result.scene}, {share}, in {result.frames} frames "
        f"({result.ended}); {result.wall_seconds:.1f} s"
    )


def main(order: Order) -> int:
    """The command: play, then say how it went and where the files are."""
    if os.getcwd() not in sys.path:
        sys.path.insert(0, os.getcwd())  # an installed command does not look for the user's agent where the user is
    result = play(order)
    print(summary(result))
    if order.video is not None:
        for suffix, what in ((".mp4", "video"), (".json", "result"), (".html", "page")):
            print(f"{what}: {order.video.with_suffix(suffix).resolve()}")
    return 0
