"""The sketch once more, for one rescue and without numpy's batches: what the fast one is compared with.

It is written from the rules in the docstring of `hazard_ms.sketch.world` and shares only the random numbers with it.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import torch

from hazard_ms.simulation.chance import Chance
from hazard_ms.sketch.rescues.scene import SketchScene
from hazard_ms.sketch.skill_times import SkillTimes

TARGETS, CARTS, MARKS, SLOTS = 32, 3, 8, 4  # numbers of options, and looks on a way
STILL = math.radians(25.0)  # turns up to this are made while driving [rad]
PER_RADIAN = 30.0 / math.pi  # frames of a turn on the spot


class SlowSketch:
    """One rescue in one scene."""

    def __init__(self, scene: SketchScene, times: SkillTimes, seed: int, missed: float = 0.0) -> None:
        """Begin the episode of `seed`."""
        self.s, self.times, self.missed = scene, times, missed
        self.chance = Chance(1)
        self.chance.restart(torch.tensor([0]), torch.tensor([seed]))
        self.frame, self.site = 0, 0
        self.place, self.heading = tuple(scene.position[0]), scene.heading
        self.held: int | None = None
        self.rescued: dict[int, int] = {}
        self.spoiled: set[int] = set()
        self.laid: dict[int, int] = {}
        self.known: set[tuple[str, int]] = set()
        self.seen_at: dict[int, int] = {}
        self.failures: dict[tuple[str, int], int] = {}
        self.visits = [0] * len(scene.landmark_site)
        self.spots = [0] * len(scene.landmark_site)
        self.looked = self.over = False
        self.look([self.place], [self.heading], [0])

    def at(self, target: int, frame: int) -> int:
        k = min(frame // 10, len(self.s.target_site) - 1)
        return self.laid.get(target, int(self.s.target_site[k, target]))

    def stand(self, point: Any) -> int:
        count = self.s.grid_shape[1]
        x, y = (int((point[i] - self.s.grid_origin[i]) / self.s.grid_cell) for i in (0, 1))
        x, y = min(max(x, 0), count - 1), min(max(y, 0), self.s.grid_shape[0] - 1)
        return int(self.s.stand_of[y * count + x])

    def things(self, frame: int) -> list[tuple[str, int, int, int]]:
        """Kind, number, site and number of the random draw of all things that are there."""
        made = [
            ("target", t, self.at(t, frame), t)
            for t in range(len(self.s.value))
            if t not in self.rescued and t != self.held
        ]
        made += [("cart", c, int(site), TARGETS + c) for c, site in enumerate(self.s.cart_site)]
        return made + [("mark", m, int(site), TARGETS + CARTS + m) for m, site in enumerate(self.s.landmark_site)]

    def look(self, points: Any, headings: Any, frames: Any) -> None:
        draws = self.chance.uniform("sketch.sight", TARGETS + CARTS + len(self.visits))[0].tolist()
        for point, heading, frame in zip(points, headings, frames, strict=True):
            for kind, number, site, draw in self.things(frame):
                off = self.s.position[site] - np.array(point)
                turn = 0.0 if heading is None else math.atan2(off[1], off[0]) - heading
                ahead = math.cos(turn) >= 0.5 and off.any()
                if kind == "mark" and ahead:
                    self.spots[number] |= int(self.s.spots[self.stand(point), number])
                least = 3.0 * math.cos(math.radians(52.5) if heading is None else turn) ** 3
                if ahead and self.s.pixels[self.stand(point), site] >= least and draws[draw] >= self.missed:
                    self.known.add((kind, number))
                    if kind == "target":
                        self.seen_at[number] = site

    def marks(self) -> list[int]:
        """The landmarks of the slots."""
        scored = []
        for mark, site in enumerate(self.s.landmark_site):
            every = int(np.bitwise_or.reduce(self.s.spots[:, mark]))
            unseen = bin(every & ~self.spots[mark]).count("1")
            away = math.dist(self.s.position[site], self.place)
            if ("mark", mark) in self.known and self.visits[mark] < 2:
                scored.append((-(2.5 + 3.4 * unseen) / (1.0 + away) / (1 + self.visits[mark]) ** 2, mark))
        return [mark for _, mark in sorted(scored)[:MARKS]]

    def options(self) -> set[int]:
        """Numbers of the options that can be chosen."""
        made = set()
        for t in range(len(self.s.value)):
            usable = ("target", t) in self.known and self.failures.get(("target", t), 0) < 4
            if self.held is None and usable and t not in self.rescued:
                made.add(t)
        for c in range(len(self.s.cart_site)):
            if self.held is not None and ("cart", c) in self.known and self.failures.get(("cart", c), 0) < 4:
                made.add(TARGETS + c)
        made |= {TARGETS + CARTS + k for k in range(len(self.marks()))}
        if not (self.looked and made):
            made.add(TARGETS + CARTS + MARKS)
        return made | {TARGETS + CARTS + MARKS + 1} if not self.over else set()

    def step(self, option: int) -> None:
        """Play one option."""
        if self.over:
            return
        self.chance.frame += 1
        self.luck = self.chance.uniform("sketch.skill", 6)[0].tolist()
        before, stopped = self.frame, False
        if option in self.options():
            if option < TARGETS:
                self.note(("target", option), self.fetch(option))
            elif option < TARGETS + CARTS:
                self.note(("cart", option - TARGETS), self.stow(option - TARGETS))
            elif option < TARGETS + CARTS + MARKS:
                self.search(self.marks()[option - TARGETS - CARTS])
            elif option == TARGETS + CARTS + MARKS:
                self.explore()
            else:
                stopped = True
        if self.frame == before and not stopped:
            self.frame = min(self.frame + 10, self.s.max_frames)
        for t, safe_at in enumerate(self.s.safe_at):
            free = t not in self.rescued and t not in self.laid and t != self.held
            if free and 0 <= safe_at <= self.frame:
                self.rescued[t] = int(safe_at)
                if 0 <= self.s.damaged_at[t] <= safe_at:
                    self.spoiled.add(t)
        self.over = stopped or self.frame >= self.s.max_frames or len(self.rescued) == len(self.s.value)

    def note(self, thing: tuple[str, int], worked: bool) -> None:
        self.looked = False
        self.failures[thing] = self.failures.get(thing, 0) + (not worked)

    def fetch(self, target: int) -> bool:
        goal = self.seen_at[target]
        for _ in range(2):
            if self.s.pixels[self.stand(self.place), self.at(target, self.frame)] >= 3:
                goal = self.meeting(target)
            if not self.walk(goal):
                return False
            actual = self.at(target, self.frame)
            if math.dist(self.s.position[actual], self.s.position[goal]) < 0.7:
                break
            if self.s.pixels[self.stand(self.place), actual] < 3:
                return False
        else:
            return False
        if not self.skill("pick_up", 0, float(self.s.height[target])):
            return False
        if 0 <= self.s.damaged_at[target] <= self.frame:
            self.spoiled.add(target)
        self.held = target
        return True if len(self.s.cart_site) else self.drop("bag")

    def meeting(self, target: int) -> int:
        if len(self.s.target_site) == 1 or target in self.laid:
            return self.at(target, self.frame)
        last = len(self.s.target_site) - 1
        for k in range(min(self.frame // 10, last), last):
            site = int(self.s.target_site[k, target])
            if self.frame + self.frames_to(site) < (k + 1) * 10:
                return site
        return int(self.s.target_site[last, target])

    def drop(self, skill: str) -> bool:
        worked, target, self.held = self.skill(skill, 2, 0.0), self.held, None
        assert target is not None
        if worked:
            self.rescued[target] = self.frame
        else:
            self.laid[target] = self.seen_at[target] = self.site
        return worked

    def stow(self, cart: int) -> bool:
        return self.walk(int(self.s.cart_site[cart])) and self.drop("cart")

    def search(self, mark: int) -> None:
        goal = int(self.s.landmark_site[mark])
        self.visits[mark] += 1
        self.looked = False
        reachable = math.isfinite(self.frames_to(goal))
        self.walk(goal)
        if reachable:
            self.explore()

    def explore(self) -> None:
        self.looked = self.skill("explore", 0, 0.0)
        self.look([self.place], [None], [self.frame])

    def skill(self, name: str, draw: int, height: float) -> bool:
        for row in self.times.rows:
            if row.skill == name and row.height[0] <= height < row.height[1]:
                break
        worked = self.luck[draw] < row.success
        points = row.frames if worked else row.failed
        at = self.luck[draw + 1] * (len(points) - 1)
        low = int(at)
        high = min(low + 1, len(points) - 1)
        end = self.frame + round(points[low] + (at - low) * (points[high] - points[low]))
        self.frame = min(end, self.s.max_frames)
        return worked and end <= self.s.max_frames

    def frames_to(self, goal: int) -> float:
        if self.site == goal:
            return 0.0
        stand = self.stand(self.place)
        first = float(self.s.first[stand, goal])
        off = np.array(self.place) - self.s.stand[stand]
        gained = 62.0 * float(off @ [math.cos(first), math.sin(first)])
        turn = abs(math.remainder(first - self.heading, 2 * math.pi))
        return max(float(self.s.travel[stand, goal]) - gained, 0.0) + PER_RADIAN * max(turn - STILL, 0.0)

    def walk(self, goal: int) -> bool:
        frames = self.frames_to(goal)
        room = self.s.max_frames - self.frame
        if math.isinf(frames):
            lost = next(row for row in self.times.rows if row.skill == "no_path").failed
            assert len(lost) == 1
            self.frame += round(min(lost[0], room))
            return False
        if frames == 0.0:
            return True
        spent = min(frames, 800.0, room)
        share, stand = spent / frames, self.stand(self.place)
        corners = [self.place, *self.s.way[stand, goal]]
        points, headings, when = [], [], []
        for k in range(1, SLOTS + 1):
            at = k * share
            piece = min(int(at), SLOTS - 1)
            a, b = np.array(corners[piece]), np.array(corners[piece + 1])
            points.append(a + (at - piece) * (b - a))
            headings.append(math.atan2(*(b - a)[::-1]))
            when.append(self.frame + round(spent * k / SLOTS))
        if share == 1.0:
            headings[-1] = float(self.s.last[stand, goal])
        self.look(points, headings, when)
        self.place, self.heading = tuple(points[-1]), headings[-1]
        self.frame += round(spent)
        self.site = goal if share == 1.0 else -1
        return share == 1.0

    @property
    def value(self) -> float:
        """Value rescued so far as a share of all."""
        saved = sum(self.s.value[t] * (0.5 if t in self.spoiled else 1.0) for t in self.rescued)
        return float(saved / max(self.s.value.sum(), 1.0))
