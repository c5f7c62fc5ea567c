"""The pictures of a rescue under way: the third person, the head camera, the hazard over it, and the semantic map."""

from __future__ import annotations

from collections.abc import Iterator

import cv2
import numpy as np
from numpy.typing import NDArray

from hazard_ms.cli.web.playing.link import HAZARD, HEAD, MAP, ROOM
from hazard_ms.pictures.drawing import Pixels
from hazard_ms.pictures.panels import MapPanel, hazard_panel, strongest
from hazard_ms.pictures.peak_levels import peak_levels
from hazard_ms.pictures.spectator import Spectator
from hazard_ms.skills.executor import SkillEnv
from hazard_ms.skills.mitigations.offers import tools

SIZE = (400, 300)  # of the third person [pixels]: larger ones are too few a second on two cores [measured]
PLAN = (480, 320)  # of the map [pixels]
QUALITY = 80  # of JPEGs, of 100 [ours]
HEAD_EVERY = 16  # pictures of the third person for one of the head camera, which takes as long as two of them [ours]
MAP_EVERY = 4  # pictures for one of the map [ours]
NEAR = 14.0  # distance on the map within which a click means a thing [pixels] [ours]
PATH_STEP = 0.05  # shortest piece of the drawn path [m]


class Pictures:
    """Takes the pictures of one episode as JPEGs; looks change nothing in it."""

    def __init__(self, env: SkillEnv, room: bool) -> None:
        """Begin with the episode that has begun in `env`; `room`: whether the third person is shown."""
        self._env, self._room = env, room
        self._levels = tuple(hazard.shown_level for hazard in env.base.task.hazards)
        self._map = MapPanel(*PLAN, self._levels)
        self._path: list[tuple[float, float]] = []
        self._count = 0
        self._spectator = Spectator(env, near=True)
        self._camera = self._spectator.camera
        self._labels: NDArray[np.int64] | None = None
        self._look()

    def moved(self) -> None:
        """Note where the robot is now."""
        x, y, _ = self._env.stage.robot.base()
        if not self._path or np.hypot(x - self._path[-1][0], y - self._path[-1][1]) > PATH_STEP:
            self._path.append((x, y))

    def due(self, goal: str | None, everything: bool = False) -> Iterator[tuple[str, bytes]]:
        """The pictures that are due now, by what they show; `goal`: the thing that the robot acts on."""
        self._count += 1
        if self._room:
            yield ROOM, _jpeg(self._take_room())
        if everything or self._count % (HEAD_EVERY if self._room else 2) == 0:
            if not everything or self._stale:
                self._look()
            yield HEAD, _jpeg(self._head)
            if self._level is not None and np.isfinite(self._level).any(axis=(1, 2)).all():
                which = strongest(self._told, self._levels)
                panel = hazard_panel(self._head, self._level[which], self._levels[which], self._told[which])
                yield HAZARD, _jpeg(panel)
        if everything or self._count % MAP_EVERY == 0:
            yield MAP, _jpeg(self._plan(goal))

    def _take_room(self) -> Pixels:
        base = self._env.base
        base.observer.show()
        with self._spectator.looking():
            base.scene.update_render(update_sensors=False, update_human_render_cameras=True)
            self._camera.capture()
        self._labels, self._stale = None, True
        return np.ascontiguousarray(self._camera.get_obs(**_only("rgb"))["rgb"][0].cpu().numpy())

    def _look(self) -> None:
        rgb, view = self._env.base.observer.look()
        self._head, self._level, self._seen = np.ascontiguousarray(rgb.cpu().numpy()), view.level, view.labels
        self._told = peak_levels(self._env, view)
        self._stale = False

    def _plan(self, goal: str | None) -> Pixels:
        env, labeller = self._env, self._env.labeller
        targets = labeller.targets(env.seen.seen_damaged)
        self._map.openings = env.stage.doors.rows()
        self._map.tools = [labeller.index(tool.name) for tool in tools(env.stage) if not tool.held]
        return self._map.draw(env.seen, targets, labeller.names, env.stage.robot.base(), self._path, goal)

    def thing_at(self, picture: str, across: float, down: float) -> str | None:
        """The thing that is seen in a picture at a place, each from 0 to 1 from its upper left corner; None: none."""
        if picture == MAP:
            return self._on_map(across * PLAN[0], down * PLAN[1])
        labels = self._room_labels() if picture == ROOM and self._room else self._seen
        if labels is None:
            return None
        height, width = labels.shape
        row, column = min(int(down * height), height - 1), min(int(across * width), width - 1)
        names = self._env.base.world.names[0]
        label = int(labels[row, column])
        return names[label] if 0 <= label < len(names) else None

    def _room_labels(self) -> NDArray[np.int64]:
        """Labels of the third person's last picture, [H, W]."""
        if self._labels is None:
            seen = self._camera.get_obs(**_only("segmentation"))["segmentation"]
            self._labels = self._env.base.observer.labelled(seen)[0].cpu().numpy()
        return self._labels

    def _on_map(self, x: float, y: float) -> str | None:
        names = self._env.labeller.names
        if not self._map.window:
            return None
        places = {names[i]: sighting.position for i, sighting in self._env.seen.objects.items()}
        places |= {o.name: np.array(o.position) for o in self._env.stage.doors.rows()}
        away = {n: float(np.hypot(*np.subtract(self._map.pixel(at), (x, y)))) for n, at in places.items()}
        best = min(away, key=lambda n: away[n], default=None)
        return best if best is not None and away[best] <= NEAR else None


def _only(wanted: str) -> dict[str, bool]:
    """The arguments of ManiSkill's `get_obs` for one texture alone."""
    return {**dict.fromkeys(("rgb", "depth", "position", "segmentation", "normal", "albedo"), False), wanted: True}


def _jpeg(picture: Pixels) -> bytes:
    _, made = cv2.imencode(".jpg", cv2.cvtColor(picture, cv2.COLOR_RGB2BGR), [cv2.IMWRITE_JPEG_QUALITY, QUALITY])
    return made.tobytes()
