"""Films an episode of a team: every few frames a picture of the scene, and of what each robot sees and has seen."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np

from hazard_ms.evaluation.metrics import Fate, Tally
from hazard_ms.evaluation.runner import fates
from hazard_ms.pictures.compositor import Shot
from hazard_ms.pictures.drawing import Pixels
from hazard_ms.pictures.film import LOOK_EVERY, PATH_STEP, Filming, known_targets
from hazard_ms.pictures.spectator import Spectator
from hazard_ms.pictures.team_compositor import TeamCompositor
from hazard_ms.skills.decision import Decision
from hazard_ms.skills.mitigations.offers import tools
from hazard_ms.skills.team import TeamSkills


class TeamFilm(Filming):
    """The film of one episode of a team."""

    def begin(self, env: TeamSkills, decision: Decision) -> None:
        """Start the encoder."""
        self._env, self._spectator = env, Spectator(env)
        self._ways: dict[str, list[tuple[float, float]]] = {name: [] for name in env.names}
        levels = tuple(h.shown_level for h in env.base.task.hazards)
        self._compositor = TeamCompositor(*self.start(env.base), levels, env.names)

    def frame(self, action: Any) -> None:
        """Take a picture where one is due; `action`, by robot, in its controllers' units, is not looked at."""
        for name, robot in self._env.base.robots.items():
            x, y, _heading = robot.base()
            way = self._ways[name]
            if not way or np.hypot(x - way[-1][0], y - way[-1][1]) > PATH_STEP:
                way.append((x, y))
        if self._env.frame % self._every == 0:
            self.shoot()

    def shoot(self) -> Pixels:
        """Take a picture now, and add it to the film."""
        env, base = self._env, self._env.base
        if self._shots % LOOK_EVERY == 0:
            looks = [observer.look()[0].cpu().numpy() for observer in base.observers]
            self._heads = dict(zip(env.names, looks, strict=True))
        self._shots += 1
        with self._spectator.looking():
            room = base.render()[0].cpu().numpy()
        now = fates(env)
        self._news.rescues(now)
        news = self._news.shown()
        shots = {name: replace(self._shot(name, now, room), news=news, good_news=self._news.good) for name in env.names}
        picture = self._compositor.compose(shots, env.stopped, env.collisions)
        self._video.add(picture)
        return picture

    def _shot(self, name: str, now: tuple[Fate, ...], room: Pixels) -> Shot:
        """What the picture shows of one robot."""
        env, known, doing = self._env, self._env.knowledge[name], self._env.doing.get(name)
        return Shot(
            third_person=room,
            head=self._heads[name],
            level=None,
            told=(),
            map=known.seen,
            openings=known.stage.doors.rows(),
            tools=tuple(known.labeller.index(tool.name) for tool in tools(known.stage) if not tool.held),
            names=known.labeller.names,
            targets=known_targets(known.labeller, now),
            frame=env.frame,
            max_frames=env.max_frames,
            agent=known.stage.robot.base(),
            path=tuple(self._ways[name]),
            verb="" if doing is None else doing.verb,
            target=None if doing is None else doing.target,
            note="",
            held=known.labeller.held,
            value=Tally.of(now).value,
        )
