"""Keeps a rescue as every other episode is kept: result, page and film; of a person also a demonstration.

The film is made afterwards: the episode is simulated again by its decisions, which also shows that it can be.
"""

from __future__ import annotations

import contextlib
import os
import re
import time
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

from hazard_ms.agents.latency import OFF
from hazard_ms.demonstrations import claims, store
from hazard_ms.demonstrations.card import write_card
from hazard_ms.demonstrations.layout import MANIFEST
from hazard_ms.demonstrations.options import RecordOptions
from hazard_ms.demonstrations.recording import REWARD, Verdict, put, recorded
from hazard_ms.demonstrations.repair import repair
from hazard_ms.demonstrations.watching.foresight import Foresight
from hazard_ms.demonstrations.watching.recorder import Recorder
from hazard_ms.evaluation.attempts import Recorded
from hazard_ms.evaluation.averted.account import Account
from hazard_ms.evaluation.averted.loss import Loss
from hazard_ms.evaluation.options import EnvOptions, EpisodeOptions
from hazard_ms.evaluation.page import address, page
from hazard_ms.evaluation.replay import EXACT, compare
from hazard_ms.evaluation.result import EpisodeResult
from hazard_ms.evaluation.runner import play
from hazard_ms.evaluation.watchers import Watcher
from hazard_ms.pictures.compositor import RENDERED
from hazard_ms.pictures.film import Film
from hazard_ms.skills.context import LowLevel
from hazard_ms.skills.decision import STOP
from hazard_ms.skills.executor import SkillEnv
from hazard_ms.spec.registry.detectors import TRUTH
from hazard_ms.spec.storage.files import drafts, make_folder, write_together

EVERY = 6  # frames from one picture of the film to the next, as `hazard-ms play` takes them
DEMOS = "_demos"  # after the name of the folder of results: the folder of demonstrations, beside it
TELL_EVERY = 60  # frames from one word about the film to the next [ours]


class Teller(Watcher):
    """Says how far the film is."""

    def __init__(self, say: Callable[[int], None]) -> None:
        self._say = say

    def begin(self, env: SkillEnv, decision: object) -> None:
        """Remember the environment; `decision`, the first one, is not looked at."""
        self._env = env

    def frame(self, action: LowLevel) -> None:
        """Say it now and then; `action`, [A], in the units of the robot's controllers, is not looked at."""
        if self._env.frame % TELL_EVERY == 0:
            self._say(self._env.frame)


def place(folder: Path, result: EpisodeResult, name: str) -> Path:
    """The file of the result of the rescue called `name`."""
    text = f"{result.env_id}-{result.scene}-{result.seed:04d}-{result.agent}-{name}"
    return folder / f"{re.sub(r'[^0-9A-Za-z_-]+', '.', text)}.json"


def keep(path: Path, result: EpisodeResult) -> None:
    """Write the result and its page. Raises ValueError where they cannot be written."""
    write_together({path: result.to_json(), path.with_suffix(".html"): page(result)})


def kept(folder: Path, name: str) -> tuple[Path, EpisodeResult] | None:
    """The file and the result that `keep` has written for the rescue called `name`; None if there is none."""
    for path in folder.glob(f"*-{name}.json"):
        with contextlib.suppress(ValueError):
            return path, EpisodeResult.read(path)
    return None


def lost_alone(options: EpisodeOptions) -> Loss | None:
    """The loss in the episode of `options` if nobody acts, which is played for that; None if its simulation broke."""
    alone = replace(options, agent="random", clock=OFF, perception=TRUTH)
    return play(alone, [Account()], Recorded(((STOP, None),), "random")).lost


def film(
    path: Path, options: EpisodeOptions, result: EpisodeResult, say: Callable[[int], None], teaches: bool
) -> tuple[str, Path | None]:
    """Simulate the episode of `result` again and film it; where it `teaches`, keep it as a demonstration, too.

    Only what is the same episode again becomes a demonstration. Returns how the replay compares, and the folder of the
    demonstration; None if there is none, or one of this scene and seed already. Raises ValueError where something
    cannot be written.
    """
    start = time.perf_counter()
    actions = tuple((d.verb, d.target) for d in result.decisions)
    waits, notes = tuple(d.waited for d in result.decisions), tuple(d.note for d in result.decisions)
    player = Recorded(actions, result.agent, waits, notes)
    recorder = Recorder(privileged=False)
    foresight = Foresight(recorder)
    camera = {"width": RENDERED[0], "height": RENDERED[1]}
    shown = path.with_suffix(".html")
    with drafts(path.with_suffix(".mp4"), shown) as (shot, told):
        with Film(shot, f"{result.agent}, seed {result.seed}", EVERY) as movie:
            drawn = {"render_mode": "rgb_array", "human_render_camera_configs": camera}
            if teaches:
                drawn["reward_mode"] = REWARD
            watchers = [Teller(say), *((recorder, foresight) if teaches else ()), movie]
            again = play(options, watchers, player, **drawn)
        told.write(page(result, address(shot.path, path.with_suffix(".mp4").name)))
    verdict, why = compare(result, again)
    if verdict != EXACT or not teaches:
        return f"{verdict}{why}", None
    seconds = {**result.phase_seconds, "verify": time.perf_counter() - start}
    output = Path(f"{os.path.abspath(path.parent)}{DEMOS}")  # the folder may be called `.`
    return verdict, _demonstrate(output, options, result, (recorder, foresight), seconds)


def _demonstrate(
    output: Path,
    options: EpisodeOptions,
    result: EpisodeResult,
    watched: tuple[Recorder, Foresight],
    seconds: dict[str, float],
) -> Path | None:
    """Enter the episode into the dataset of its task and agent; None if one of its scene and seed is there."""
    env = EnvOptions(**{name: getattr(options, name) for name in EnvOptions.__dataclass_fields__})
    how = RecordOptions(env=env, agent=result.agent, seed=result.seed, keep=0.0, output=output)
    make_folder(how.dataset)
    (how.dataset / MANIFEST).touch()
    repair(how.dataset)
    with claims.claimed(how.dataset, result.seed) as mine:
        if not mine or any(e.seed == result.seed for e in recorded(how.dataset, how.recipe)):
            return None
        told = replace(result, phase_seconds=seconds)
        part = store.begin(how.dataset, result.seed)
        made = put(part, how, told, watched, Verdict("", True, seconds, privileged=False))
    write_card(how.dataset)
    return made
