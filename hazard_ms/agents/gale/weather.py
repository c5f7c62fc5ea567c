"""The belief of an agent about a gale, from the winds that it has seen: a filter over the courses that are possible.

A course is where the wind blows to before the front, by how much and which way it turns, and when the front passes.
Agents see how fast the air is, not where it blows to. The lee tells: over floor behind a car the air is slow. So each
course is weighed by how well the speeds that it predicts over the floor, with the lees of all that stands on the map,
agree with those that were seen. The fastest air of the first look around is that before the front, half as fast as what
comes, or where the front has passed far upwind already.
"""

from __future__ import annotations

import numpy as np
import torch
from numpy.typing import NDArray

from hazard_ms.agents.gale.course import Array, Course, Front, Lees
from hazard_ms.agents.gale.shelters import Shelters, shelters
from hazard_ms.hazards.wind import shelter
from hazard_ms.hazards.wind.gale import GUST_RATIO, TURN, Gale
from hazard_ms.skills.brief import Brief
from hazard_ms.skills.decision import Decision

HEADINGS = 32  # directions that are told apart [ours]
TURNS = 7  # sizes of the turn that are told apart, from the least to the greatest [ours]
ONSETS = 6  # times of the front that are told apart [ours]
ERROR = 0.2  # standard deviation of a speed that is seen, over the fastest wind [-] [ours: lees of what is half seen]
SAMPLES = 60  # places of each decision whose speeds count [ours]
CORRELATED = 8.0  # places near each other tell no more than one: so many count as one [ours]
STRONG = 95.0  # percentile of the speeds of the first looks that is taken for the wind in the open [%] [ours]
FIRST = 3.0  # time up to which looks are the first [s] [ours: a look around takes 2 s]
FACTORS = (1.0, 2.0)  # the wind behind the front over the fastest air of the first looks
COURSES = 16  # that are looked at for what a place keeps [ours]
USUAL_FRAME = 1.0 / 30.0  # duration of a frame for which the law's times are given [s] [docs/physics.md 1.3.1]
CHANGED = 25  # cells of shelter by which the map must have changed for new lees [ours]


class Weather:
    """The belief of one episode; `note` enters what each decision shows."""

    def __init__(self, brief: Brief) -> None:
        """Begin with all courses of the law of HazardGale-v1 equally likely."""
        self._seconds, self._end = brief.frame_seconds, brief.max_frames * brief.frame_seconds
        # `shipped` has shorter frames, and all times of its front are as much shorter (hazard_ms.hazards.presets)
        self._scale = brief.frame_seconds / USUAL_FRAME
        self._law = Gale()
        half = HEADINGS // 2
        steps = np.linspace(TURN[0], TURN[1], TURNS) / (2.0 * np.pi / HEADINGS)
        sizes = np.unique(2 * np.rint(steps / 2).astype(int))  # even, so that half of a turn is a heading, too
        onsets = self._scale * np.linspace(self._law.earliest, self._law.latest, ONSETS)
        turns = np.concatenate([sizes, -sizes])
        grid = np.meshgrid(2 * np.arange(half), turns, onsets, np.array(FACTORS), indexing="ij")
        first, turn, onset, self._factor = (part.ravel() for part in grid)
        self._winds = np.stack([first, first + turn // 2, first + turn], -1).astype(int) % HEADINGS  # [H, 3]
        self._onset = onset
        self._log = np.zeros(len(onset))  # logarithms of weights
        self._seen = np.zeros((0, 0), np.float32)  # levels of the last decision
        self._shelters: Shelters | None = None
        self._lees: Lees | None = None
        self._fastest = 0.0  # air of the first looks [m/s]; 0: none was seen yet
        self._middle = np.zeros(2)

    @property
    def known(self) -> bool:
        """Whether it has seen any wind."""
        return self._fastest > 0.0 and self._lees is not None

    def note(self, decision: Decision) -> None:
        """Enter the speeds over floor that a decision shows and the last one did not, and what stands there."""
        levels = decision.map.levels[0]
        fresh = np.isfinite(levels) & decision.map.explored & (decision.map.height < 0.1)
        if self._seen.shape == levels.shape:
            fresh &= levels != self._seen
        self._seen = np.array(levels)
        self._look_at(decision)
        if not fresh.any():
            return
        y, x = np.nonzero(fresh)
        pick = np.linspace(0, len(y) - 1, min(SAMPLES, len(y))).astype(int)
        points = decision.map.origin + (np.stack([x[pick], y[pick]], -1) + 0.5) * decision.map.cell
        speeds, time = levels[y[pick], x[pick]].astype(np.float64), decision.frame * self._seconds
        if time < self._scale * FIRST and (fast := float(np.percentile(levels[fresh], STRONG))) > self._fastest:
            self._fastest = fast
            self._log[:] = 0.0
        if self.known:
            self._weigh(np.hstack([points, np.zeros((len(points), 1))]), speeds, time)

    def _weigh(self, points: Array, speeds: Array, time: float) -> None:
        """Weigh the courses by the `speeds` [m/s], [P], at `points` [m], [P, 3], at a `time` [s]."""
        assert self._lees is not None
        left = self._lees.left(points)  # [K, P]
        shares = self._shares(points, time)  # [H, P, 3]
        factor = np.array([self._law.before, 1.0, 1.0])
        unit = self._unit(np.arange(HEADINGS))
        flow = np.einsum("hpw,hwp,hwd->hpd", shares * factor, left[self._winds], unit[self._winds])
        speed = self._fastest * self._factor[:, None]
        off = (speed * np.hypot(flow[..., 0], flow[..., 1]) - speeds) / (ERROR * self._fastest)
        self._log -= np.minimum(0.5 * off**2, 4.0).sum(1) / CORRELATED
        self._log -= self._log.max()

    def _shares(self, points: Array, time: float) -> Array:
        """Shares of the three winds at `points` [m], [P, 3], at a `time` [s], in each of the H courses: [H, P, 3]."""
        way = self._unit(self._winds[:, 1])
        ahead = (points[None, :, :2] - self._middle) @ way[..., None]
        since = time - self._onset[:, None] - ahead[..., 0] * GUST_RATIO / (self._fastest * self._factor[:, None])
        risen = np.clip(since / (self._scale * self._law.rise), 0.0, 1.0)
        on = np.clip(since / self._scale - self._law.rise, 0.0, self._law.turning) / self._law.turning
        return np.stack([1.0 - risen, risen * (1.0 - on), risen * on], -1)

    def courses(self) -> list[tuple[float, Course]]:
        """The likeliest courses with their chances, which add up to 1."""
        assert self._lees is not None
        chance = np.exp(self._log)
        chance /= chance.sum()
        order = np.argsort(-chance, kind="stable")
        total = np.cumsum(chance[order])
        at = np.searchsorted(total, (np.arange(COURSES) + 0.5) / COURSES)
        chosen, counts = np.unique(order[np.minimum(at, len(order) - 1)], return_counts=True)
        return [(count / COURSES, self._course(int(h))) for h, count in zip(chosen, counts, strict=True)]

    def _course(self, number: int) -> Course:
        assert self._lees is not None
        winds = self._winds[number]
        speed = float(self._fastest * self._factor[number])
        flows = speed * np.array([self._law.before, 1.0, 1.0])[:, None] * self._unit(winds)
        way = self._unit(winds[1:2])[0]
        front = Front(
            float(self._onset[number]),
            (float(way[0]), float(way[1])),
            speed / GUST_RATIO,
            (float(self._middle[0]), float(self._middle[1])),
            self._scale * self._law.rise,
            self._scale * self._law.turning,
        )
        return Course(flows, Lees(self._lees.corner, self._lees.loss[winds], self._lees.cause[winds]), front, self._end)

    def _look_at(self, decision: Decision) -> None:
        """Make the lees of all winds behind what stands on the map, if that has changed."""
        found = shelters(decision)
        if self._shelters is not None and found.differ(self._shelters) < CHANGED:
            return
        self._shelters = found
        ground = np.argwhere(decision.map.explored)
        self._middle = decision.map.origin + (ground.mean(0)[::-1] + 0.5) * decision.map.cell
        height, solidity, coefficient = (
            torch.from_numpy(part).expand(HEADINGS, -1, -1).contiguous()
            for part in (found.height, found.solidity, found.coefficient)
        )
        unit = torch.from_numpy(self._unit(np.arange(HEADINGS)).astype(np.float32))
        made = shelter.lee(None, height, solidity, coefficient, unit)
        self._lees = Lees(found.corner, *(part.numpy().astype(np.float64) for part in made))

    @staticmethod
    def _unit(headings: NDArray[np.int64]) -> Array:
        """Unit vectors of headings by their numbers, [..., 2]."""
        angle = 2.0 * np.pi / HEADINGS * headings
        return np.stack([np.cos(angle), np.sin(angle)], -1)
