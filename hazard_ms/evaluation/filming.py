"""Films an episode while skills run: every so many frames a picture of the room, of what the robot sees, and of what it knows."""

from __future__ import annotations

import numpy as np

from hazard_ms.env import HazardEnv
from hazard_ms.evaluation.metrics import Fate, Tally
from hazard_ms.evaluation.panels import SCALES, TEMPERATURE
from hazard_ms.evaluation.video import Compositor, Shot, Video
from hazard_ms.sensing.target_table import Target
from hazard_ms.skills.decision import Action, Decision, Result
from hazard_ms.skills.executor import SkillEnv

NEWS_SHOTS = 45  # pictures for which news stay: 1.5 s at 30 a second
LOOK_EVERY = 4  # pictures of the film for one of the head camera: it is small, and rendering is what takes the time
LAST_SHOTS = 45  # pictures for which the end stays
PATH_STEP = 0.05  # shortest piece of the drawn path [m]


def fates(base: HazardEnv, env: int = 0) -> tuple[Fate, ...]:
    """What became of the targets of one scene, so far."""
    world, made = base.world, []
    for row in base.observer.table.rows(world, env):
        saved = bool(base.episode.rescue.safe[env, row.index])
        damaged = base.episode.rescue.damaged if saved else base.episode.damage.damaged
        frame = int(base.episode.rescue.frame[env, row.index]) if saved else None
        made.append(Fate(row.name, row.category, row.value, saved, bool(damaged[env, row.index]), frame))
    return tuple(made)


class Film:
    """The film of one episode. Tell it of each decision and result, and call `watch` after every frame."""

    def __init__(self, env: SkillEnv, video: Video, title: str, subtitle: str, every: int) -> None:
        """`every`: frames of the episode from one picture to the next."""
        hazards = [h.name for h in env.base.task.hazards]
        self._env, self._video, self._every = env, video, every
        self._compositor = Compositor(title, subtitle, SCALES.get(hazards[0], TEMPERATURE))
        self._decision: Decision | None = None
        self._action, self._note = Action("explore"), ""
        self._path: list[tuple[float, float]] = []
        self._news, self._good, self._news_left = "", True, 0
        self._saved: frozenset[str] = frozenset()
        self._shots = 0
        self._head = env.base.observer.look()

    def decided(self, decision: Decision, action: Action, note: str) -> None:
        """An agent chose `action` at `decision`."""
        self._decision, self._action, self._note = decision, action, note

    def ended(self, result: Result) -> None:
        """The last action ended so."""
        if not result.ok:
            self._tell(f"{str(self._action).replace('_', ' ', 1)}: {result.reason.replace('_', ' ')}", good=False)

    def watch(self, _: object = None) -> None:
        """A frame has passed."""
        x, y, _heading = self._env.stage.robot.base()
        if not self._path or np.hypot(x - self._path[-1][0], y - self._path[-1][1]) > PATH_STEP:
            self._path.append((x, y))
        if self._env.frame % self._every == 0:
            self.shoot()

    def close(self) -> None:
        """Hold the last picture for a while."""
        last = self.shoot()
        for _ in range(LAST_SHOTS):
            self._video.add(last)

    def shoot(self) -> np.ndarray:
        """Take a picture now, and add it to the video."""
        base = self._env.base
        if self._shots % LOOK_EVERY == 0:
            self._head = base.observer.look()
        self._shots += 1
        rgb, view = self._head
        room = base.render()[0].cpu().numpy()
        now = fates(base)
        self._tell_rescues(now)
        shown = self._news if self._news_left > 0 else ""
        self._news_left -= 1
        decision = self._env.decision() if self._decision is None else self._decision
        picture = self._compositor.compose(
            Shot(
                third_person=room,
                head=rgb.cpu().numpy(),
                level=np.zeros((16, 16)) if view.level is None else view.level,
                map=decision.map,
                names=decision.names,
                targets=self._targets(decision, now),
                frame=self._env.frame,
                max_frames=self._env.max_frames,
                agent=self._env.stage.robot.base(),
                path=tuple(self._path),
                verb=self._action.verb,
                target=self._action.target,
                note=self._note,
                held=self._held(),
                value=Tally.of(now).value,
                news=shown,
                good_news=self._good,
            )
        )
        self._video.add(picture)
        return picture

    def _held(self) -> str | None:
        held = self._env.stage.held
        return self._env.base.world.names[0][held] if held >= 0 else None

    def _targets(self, decision: Decision, now: tuple[Fate, ...]) -> tuple[Target, ...]:
        """The target table as it is at this frame; the audience is told of all damage, the agent only of what it sees."""
        damaged = {decision.index(f.name) for f in now if f.damaged}
        return self._env.base.observer.table.rows(self._env.base.world, 0, damaged)

    def _tell(self, news: str, good: bool) -> None:
        self._news, self._good, self._news_left = news, good, NEWS_SHOTS

    def _tell_rescues(self, now: tuple[Fate, ...]) -> None:
        saved = frozenset(f.name for f in now if f.rescued)
        for fate in now:
            if fate.rescued and fate.name not in self._saved:
                self._tell(f"{fate.name} is safe" + (", but damaged" if fate.damaged else ""), good=True)
        self._saved = saved
