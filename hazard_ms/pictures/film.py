"""Films an episode: every few frames a picture of the room, of what the robot sees, and of what it knows."""

from __future__ import annotations

import abc
from contextlib import ExitStack
from types import TracebackType
from typing import Any

import numpy as np

from hazard_ms.evaluation.metrics import Fate, Tally
from hazard_ms.evaluation.runner import fates
from hazard_ms.evaluation.video import Video
from hazard_ms.evaluation.watchers import Watcher
from hazard_ms.pictures.compositor import HEIGHT, WIDTH, Compositor, Shot
from hazard_ms.pictures.drawing import Pixels
from hazard_ms.pictures.news import News
from hazard_ms.pictures.peak_levels import peak_levels
from hazard_ms.pictures.spectator import Spectator
from hazard_ms.sensing.detection.labeller import Labeller
from hazard_ms.sensing.target_table import Target
from hazard_ms.skills.context import LowLevel
from hazard_ms.skills.decision import EXPLORE, Action, Decision, Result
from hazard_ms.skills.executor import SkillEnv
from hazard_ms.skills.failures import UNFINISHED
from hazard_ms.skills.mitigations.offers import tools
from hazard_ms.spec.storage.files import Draft

RATE = 24.0  # pictures of a film per second
LOOK_EVERY = 4  # pictures of the film for one of the head camera: it is small, and rendering is what takes the time
LAST_SHOTS = 45  # pictures for which the end stays
PATH_STEP = 0.05  # shortest piece of the drawn path [m]


class Filming(Watcher, abc.ABC):
    """A film that is written to a draft. A context manager, so that a broken episode stops the encoder."""

    def __init__(self, draft: Draft, subtitle: str, every: int) -> None:
        """`every`: frames of the episode from one picture to the next. The film's speed is added to `subtitle`."""
        self._draft, self._subtitle, self._every = draft, subtitle, every
        self._files, self._news, self._shots = ExitStack(), News(), 0

    def start(self, base: Any) -> tuple[str, str]:
        """Start the encoder, for an episode in the HazardEnv `base`. Returns the title and the subtitle of the film."""
        speed = self._every * RATE * base.control_timestep
        self._video = self._files.enter_context(Video(self._draft, (WIDTH, HEIGHT), RATE))
        return f"{base.task.name}   {base.specs[0].name}", f"{self._subtitle}, {speed:g}x speed"

    @abc.abstractmethod
    def shoot(self) -> Pixels:
        """Take a picture now, and add it to the film."""

    def finish(self, reason: str) -> None:
        """Hold the last picture for a while, and finish the film."""
        last = self.shoot()
        for _ in range(LAST_SHOTS):
            self._video.add(last)
        self._files.close()

    def __enter__(self) -> Filming:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self._files.__exit__(kind, error, trace)


class Film(Filming):
    """The film of one episode of one robot."""

    def __init__(self, draft: Draft, subtitle: str, every: int) -> None:
        """As `Filming`."""
        super().__init__(draft, subtitle, every)
        self._action, self._note = Action(EXPLORE), ""
        self._way: list[tuple[float, float]] = []

    def begin(self, env: SkillEnv, decision: Decision) -> None:
        """Start the encoder."""
        self._env, self._spectator = env, Spectator(env)
        self._compositor = Compositor(*self.start(env.base), tuple(h.shown_level for h in env.base.task.hazards))
        self._look()

    def decided(self, decision: Decision, action: Action, note: str) -> None:
        """Show `action` and its reason from now on."""
        self._action, self._note = action, note

    def ended(self, result: Result) -> None:
        """Show a failure for a while; what ran out of frames has not failed and goes on."""
        if not result.ok and result.reason not in UNFINISHED:
            self._news.tell(f"{str(self._action).replace('_', ' ', 1)}: {result.reason.replace('_', ' ')}", good=False)

    def frame(self, action: LowLevel) -> None:
        """Take a picture where one is due; `action`, [A], in the units of the robot's controllers, is not looked at."""
        x, y, _heading = self._env.stage.robot.base()
        if not self._way or np.hypot(x - self._way[-1][0], y - self._way[-1][1]) > PATH_STEP:
            self._way.append((x, y))
        if self._env.frame % self._every == 0:
            self.shoot()

    def shoot(self) -> Pixels:
        """Take a picture now, and add it to the film."""
        env, base = self._env, self._env.base
        if self._shots % LOOK_EVERY == 0:
            self._look()
        self._shots += 1
        rgb, view = self._head
        with self._spectator.looking():
            room = base.render()[0].cpu().numpy()
        now = fates(env)
        self._news.rescues(now)
        picture = self._compositor.compose(
            Shot(
                third_person=room,
                head=rgb.cpu().numpy(),
                level=view.level,
                told=self._told,
                map=env.seen,
                openings=env.stage.doors.rows(),
                tools=tuple(env.labeller.index(tool.name) for tool in tools(env.stage) if not tool.held),
                names=env.labeller.names,
                targets=known_targets(env.labeller, now),
                frame=env.frame,
                max_frames=env.max_frames,
                agent=env.stage.robot.base(),
                path=tuple(self._way),
                verb=self._action.verb,
                target=self._action.target,
                note=self._note,
                held=env.labeller.held,
                value=Tally.of(now).value,
                news=self._news.shown(),
                good_news=self._news.good,
            )
        )
        self._video.add(picture)
        return picture

    def _look(self) -> None:
        """Look through the head camera."""
        self._head = self._env.base.observer.look()
        self._told = peak_levels(self._env, self._head[1])


def known_targets(labeller: Labeller, now: tuple[Fate, ...]) -> tuple[Target, ...]:
    """The target table at a frame with the fates `now`.

    The audience is told of all damage, the agent only of what it sees.
    """
    damaged = (labeller.names.index(f.name) for f in now if f.damaged and f.name in labeller.names)
    return labeller.targets(frozenset(damaged))
