"""N robots that play options: what each option does, from its first frame to its last.

Each robot has a row of its own. Whose rows they are, and what follows for the episodes, is for `hazard_ms.sketch.world`
and, where several robots are in one rescue, for `hazard_ms.sketch.teams.world`.
"""

from __future__ import annotations

import numpy as np

from hazard_ms.sketch.fires.fates import damaged_at
from hazard_ms.sketch.fires.robots import Robots
from hazard_ms.sketch.rescues import menu
from hazard_ms.sketch.rescues.looking import target_site
from hazard_ms.sketch.rescues.pursuit import ahead, apart, in_sight, meeting
from hazard_ms.sketch.rescues.scene import Bools, Ints
from hazard_ms.sketch.skill_times import BAG, EXPLORE, PICK_UP
from hazard_ms.sketch.skill_times import CART as OVER_CART
from hazard_ms.skills.options.macros import NEAR
from hazard_ms.skills.options.options import (
    CART,
    END,
    FIRE,
    FIRST,
    LANDMARK,
    LOOK,
    MEASURED_COUNT,
    TARGET,
    TOOL,
)

TRIES = 2  # walks to a thing that moves: the second when it is seen from where it was expected [ours]
DRAWS = 6  # uniform numbers of a step: two each for the pick-up, the drop, and a walk without a path


class Options(Robots):
    """Robots, and what they can choose: `mask` [N, A], `slots` of landmarks, and the `tool` at hand."""

    slots: Ints  # see `landmark_slots`, [N, LANDMARK_SLOTS]
    tool: Ints  # see `nearest_tool`, [N]
    mask: Bools  # the options that can be chosen, [N, A]
    _stop: bool  # whether an episode can be ended

    def _play(self, rows: Ints, chosen: Ints) -> None:
        """Play the options `chosen` [R] of `rows` [R]."""
        for play, first, end in (
            (self._fetch, FIRST[TARGET], FIRST[CART]),
            (self._stow, FIRST[CART], FIRST[LANDMARK]),
            (self._search, FIRST[LANDMARK], FIRST[LOOK]),
            (self._explore, FIRST[LOOK], FIRST[END]),
            (self._put_out, FIRST[FIRE], FIRST[TOOL]),
            (self._arm, FIRST[TOOL], MEASURED_COUNT),
        ):
            some = np.flatnonzero((chosen >= first) & (chosen < end))
            if len(some):
                play(rows[some], chosen[some] - first)

    def _fetch(self, rows: Ints, target: Ints) -> None:
        """Walk to a target and pick it up; with a bag, put it in. A tool in the hand is put down before."""
        state = self.state
        self._lay_down(rows)
        goal, here, trying = state.seen_site[rows, target], np.zeros(len(rows), bool), np.arange(len(rows))
        for _ in range(TRIES):
            some, wanted = rows[trying], target[trying]
            goal[trying], arrived = self._approach(some, wanted, goal[trying])
            here[trying], again = self._arrive(some, wanted, goal[trying], arrived)
            trying = trying[again]
            if not len(trying):
                break
        self._grasp(rows, target, here)

    def _approach(self, rows: Ints, target: Ints, goal: Ints) -> tuple[Ints, Bools]:
        """Walk to where a target in sight can be met, else to `goal`: the site, and whether the robot arrived, [R]."""
        stack, state = self.stack, self.state
        site = np.where(self._sees(rows, target), meeting(stack, state, rows, target), goal)
        return site, self._walk(rows, site)

    def _arrive(self, rows: Ints, target: Ints, goal: Ints, arrived: Bools) -> tuple[Bools, Bools]:
        """Whether the target is within reach from the site `goal`, and whether another walk to it makes sense, [R]."""
        stack, state = self.stack, self.state
        actual = target_site(stack, state, rows, target, state.frame[rows])
        here = arrived & (apart(stack, state, rows, actual, goal) < NEAR) & self._lies(rows, target)
        return here, arrived & ~here & self._sees(rows, target)

    def _sees(self, rows: Ints, target: Ints) -> Bools:
        """Whether the `target` [R] can be seen now where it lies, [R]."""
        return in_sight(self.stack, self.state, rows, target) & self._lies(rows, target)

    def _lies(self, rows: Ints, target: Ints) -> Bools:
        """Whether the `target` [R] is in the hand of no other robot, nor was rescued by one, [R]."""
        return np.ones(len(rows), bool)

    def _grasp(self, rows: Ints, target: Ints, here: Bools) -> None:
        """Pick up the `target` [R] where it is `here` [R]; with a bag, put it in."""
        stack, state = self.stack, self.state
        worked = np.zeros(len(rows), bool)
        worked[here] = self._pick_up(rows[here], target[here])
        bag = worked & ~stack.cart_there[state.scene[rows]].any(axis=1)
        worked[bag] = self._let_go(rows[bag], BAG)
        state.failures[rows, target] += ~worked
        state.looked[rows] = False

    def _pick_up(self, rows: Ints, target: Ints) -> Bools:
        """Pick up what is near; whether that worked, [R]."""
        stack, state, scene = self.stack, self.state, self.state.scene[rows]
        place = stack.height[scene, target], stack.clearance[scene, target]
        ease = state.ease_of(rows, target, self.domain.again)
        worked, frames = self.times.draw(PICK_UP, self._luck[rows, :2], *place, ease)
        worked &= self._pass(rows, frames)
        state.missed[rows] = np.where(worked, -1, target)
        damaged = damaged_at(stack, state, rows)[np.arange(len(rows)), target]
        state.spoiled[rows, target] |= worked & (damaged >= 0) & (damaged <= state.frame[rows])
        state.held[rows[worked]] = target[worked]
        return worked

    def _let_go(self, rows: Ints, skill: str) -> Bools:
        """Drop what is in the hand; whether it is safe now, [R]. Where it is not, it lies where the robot is."""
        state, target, nowhere = self.state, self.state.held[rows], np.zeros(len(rows))
        safe, frames = self.times.draw(skill, self._luck[rows, 2:4], nowhere, nowhere, state.ease[rows])
        safe &= self._pass(rows, frames)
        state.held[rows] = -1
        lost = rows[~safe], target[~safe]
        state.laid[lost] = state.seen_site[lost] = state.site[rows[~safe]]
        state.rescue(rows[safe], target[safe], state.frame[rows[safe]])
        return safe

    def _stow(self, rows: Ints, cart: Ints) -> None:
        """Walk to a cart and let go of what is in the hand over it."""
        state = self.state
        arrived = self._walk(rows, self.stack.cart_site[state.scene[rows], cart])
        safe = np.zeros(len(rows), bool)
        safe[arrived] = self._let_go(rows[arrived], OVER_CART)
        state.failures[rows, self._targets + cart] += ~safe
        state.looked[rows] = False

    def _search(self, rows: Ints, slot: Ints) -> None:
        """Walk to a landmark, or as far as it goes, and look around there."""
        state, mark = self.state, self.slots[rows, slot]
        goal = self.stack.landmark_site[state.scene[rows], mark]
        state.visits[rows, mark] += 1
        state.looked[rows] = False
        reachable = np.isfinite(ahead(self.stack, state, rows, goal))
        self._walk(rows, goal)
        self._explore(rows[reachable])

    def _explore(self, rows: Ints, _: Ints | None = None) -> None:
        """Turn once around, with looks."""
        state, nothing = self.state, np.zeros(len(rows))
        frames = self.times.draw(EXPLORE, self._luck[rows, :2], nothing, nothing, np.ones(len(rows)))[1]
        whole = self._pass(rows, frames)
        self._look(rows, state.place[rows][:, None], None, state.frame[rows][:, None])
        state.looked[rows] = whole

    def _menu(self) -> None:
        self.slots = menu.landmark_slots(self.stack, self.state)
        self.tool = self.nearest_tool()
        self.mask = menu.mask(self.stack, self.state, self.slots, self._stop)
        if self.stack.measures:
            menu.offer_measures(self.mask, self.stack, self.state, self.tool)
