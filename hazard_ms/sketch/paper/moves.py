"""The six actions of `hazard_ms.skills.options.paper_actions` in the sketch, for N rescues at once.

They use the same ways, looks and times as options, which they break into pieces: a step of a walk ends after a metre,
picking up does not put into the bag, and picking up and dropping over a cart begin with the rest of the walk, up to
paper_actions.REACH. Things that can be wandered to are targets, carts and landmarks.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from hazard_ms.sensing.sighting import SEEN_PIXELS
from hazard_ms.sketch.fires.robots import THINGS
from hazard_ms.sketch.rescues.looking import HALF_VIEW, NO_DISTANCE, target_site
from hazard_ms.sketch.rescues.menu import distances
from hazard_ms.sketch.rescues.playing import DRAWS
from hazard_ms.sketch.rescues.pursuit import ahead, apart
from hazard_ms.sketch.rescues.scene import Bools, Floats, Ints
from hazard_ms.sketch.skill_times import BAG
from hazard_ms.sketch.skill_times import CART as OVER_CART
from hazard_ms.sketch.travel.geodesic import on_the_spot
from hazard_ms.sketch.travel.ways import SETTLE, TURN, WALK
from hazard_ms.sketch.world import Sketch
from hazard_ms.skills.motor.walking import MIDPOINT, SLACK, WALK_FRAMES
from hazard_ms.skills.options.macros import NEAR
from hazard_ms.skills.options.options import TARGET_SLOTS
from hazard_ms.skills.options.paper_actions import (
    COUNT,
    LET_GO,
    LOOK,
    TAKE,
    TO_CART,
    TO_TARGET,
    WANDER,
    nearest,
    possible,
)


class SixSketch(Sketch):
    """Many rescues in which `act` does one of the six actions; `step` still plays options."""

    worked: Bools  # whether the last action of each rescue did what it was for, [N]

    def possible(self) -> Bools:
        """The mask of the actions that can be done now, [N, 6]; none where the episode is over."""
        state = self.state
        (_, to_target), (_, to_cart) = self._nearest()
        carts = np.asarray(self.stack.cart_there[state.scene].any(axis=1))
        goal = (self._goals() >= 0) | self._in_sight().any(axis=1)
        return possible(to_target, to_cart, carts, state.held >= 0, goal) & ~state.over[:, None]

    def act(self, action: ArrayLike) -> tuple[Floats, Bools, Bools]:
        """Do `action` [N], columns of `possible` [N, 6].

        Returns what each rescued as a share of all value, whether it could be done, and whether the episode is over.
        An action that cannot be done costs a few frames; what is over stays as it is. Raises ValueError for anything
        but numbers of actions.
        """
        state, chosen = self.state, np.asarray(action)
        if chosen.shape != state.frame.shape or chosen.dtype.kind not in "iu":
            raise ValueError(f"action must be {len(state.frame)} whole numbers, got {chosen!r:.100}")
        if chosen.min() < 0 or chosen.max() >= COUNT:
            raise ValueError(f"action must be from 0 to {COUNT - 1}, got {chosen.min()} to {chosen.max()}")
        before, started, everyone = state.score.copy(), state.frame.copy(), np.arange(len(chosen))
        allowed = self.possible()[everyone, chosen]
        (target, _), (cart, _) = self._nearest()
        self._chance.tick()
        self._luck = self._draw("sketch.skill", DRAWS)
        self.worked = np.zeros(len(chosen), bool)
        for number, rows in ((k, np.flatnonzero(allowed & (chosen == k))) for k in range(COUNT)):
            if len(rows):
                self.worked[rows] = self._act(number, rows, target[rows], cart[rows])
        self._settle(started, np.zeros(len(chosen), bool))
        return state.score - before, allowed, state.over.copy()

    def _act(self, number: int, rows: Ints, target: Ints, cart: Ints) -> Bools:
        """Do the action with this number in `rows` [R], with the nearest `target` and `cart` [R]; whether it worked."""
        state = self.state
        if number == TO_TARGET:
            return self._one_step(rows, state.seen_site[rows, target])
        if number == TO_CART:
            return self._one_step(rows, self.stack.cart_site[state.scene[rows], cart])
        if number == TAKE:
            return self._take(rows, target)
        if number == LET_GO:
            return self._put_away(rows, cart)
        if number == LOOK:
            self._explore(rows)
            return state.looked[rows]
        assert number == WANDER
        return self._wander(rows)

    # ------------------------------------------------------------------ actions

    def _one_step(self, rows: Ints, goal: Ints) -> Bools:
        """Walk a metre towards the sites `goal` [R]; whether there was a way, [R]."""
        state, stack = self.state, self.stack
        frames = ahead(stack, state, rows, goal)
        first = stack.first[state.scene[rows], state.stand[rows], goal]
        metres = (frames - SETTLE - TURN * on_the_spot(first - state.heading[rows])) / WALK
        share = np.where(metres > MIDPOINT + SLACK, MIDPOINT / np.maximum(metres, MIDPOINT), 1.0)
        self._walk(rows, goal, np.where(np.isfinite(frames), frames, 0.0) * share * state.pace[rows])
        return np.isfinite(frames)

    def _take(self, rows: Ints, target: Ints) -> Bools:
        """Pick up the `target` [R] where it was last seen; whether it was there and could be taken, [R]."""
        stack, state = self.stack, self.state
        goal = state.seen_site[rows, target]
        arrived = self._walk(rows, goal)
        actual = target_site(stack, state, rows, target, state.frame[rows])
        here = arrived & (apart(stack, state, rows, actual, goal) < NEAR)
        worked = np.zeros(len(rows), bool)
        worked[here] = self._pick_up(rows[here], target[here])
        state.failures[rows, target] += ~worked
        return worked

    def _put_away(self, rows: Ints, cart: Ints) -> Bools:
        """Let go of what the hand holds, into the bag or over the `cart` [R] if there is one; whether it is safe."""
        stack, state, held = self.stack, self.state, self.state.held[rows]
        bag, safe = ~stack.cart_there[state.scene[rows]].any(axis=1), np.zeros(len(rows), bool)
        safe[bag] = self._let_go(rows[bag], BAG)
        lost = bag & ~safe
        beside = self._site_beside(rows[lost])  # the robot need not be at a site
        state.laid[rows[lost], held[lost]] = state.seen_site[rows[lost], held[lost]] = beside
        over, which = np.zeros(len(rows), bool), ~bag
        over[which] = self._walk(rows[which], stack.cart_site[state.scene[rows[which]], cart[which]])
        safe[over] = self._let_go(rows[over], OVER_CART)
        return safe

    def _wander(self, rows: Ints) -> Bools:
        """Walk on to the thing that each robot wanders to, or to a new one in sight; whether it arrived, [R]."""
        stack, state = self.stack, self.state
        targets, carts = state.value.shape[1], stack.cart_site.shape[1]
        marks = stack.landmark_site.shape[1]
        slots = np.r_[:targets, TARGET_SLOTS : TARGET_SLOTS + carts, THINGS : THINGS + marks]
        liking = self._draw("sketch.wander", THINGS + marks)[rows][:, slots] * self._in_sight()[rows]
        goal = self._goals()[rows]
        goal = np.where(goal >= 0, goal, np.argmax(liking, axis=1))
        site = self._known_sites()[rows, goal]
        way = np.isfinite(ahead(stack, state, rows, site))
        arrived = self._walk(rows, site, WALK_FRAMES)
        state.goal[rows] = np.where(arrived | ~way, -1, goal)
        return arrived

    # ------------------------------------------------------------------ what is known

    def _nearest(self) -> tuple[tuple[Ints, Floats], tuple[Ints, Floats]]:
        """The nearest open target and the nearest cart that are known: number, or -1, and distance [m], [N] each."""
        stack, state = self.stack, self.state
        known, targets = self.known(), state.value.shape[1]
        sites = (state.seen_site, stack.cart_site[state.scene])
        parts = (known[:, :targets], known[:, targets : targets + sites[1].shape[1]])
        one, other = (nearest(distances(stack, state, site), some) for site, some in zip(sites, parts, strict=True))
        return one, other

    def known(self) -> Bools:
        """The mask of the things that are known and neither rescued nor in the hand, [N, J]."""
        stack, state = self.stack, self.state
        targets = state.value.shape[1]
        open_ones = (state.rescued_at < 0) & (np.arange(targets) != state.held[:, None]) & stack.there[state.scene]
        rest = (stack.cart_there[state.scene], stack.mark_there[state.scene])
        return state.known & np.concatenate([open_ones, *rest], axis=1)

    def _known_sites(self) -> Ints:
        """Where things were last seen, [N, J]."""
        stack, scene = self.stack, self.state.scene
        return np.concatenate([self.state.seen_site, stack.cart_site[scene], stack.landmark_site[scene]], axis=1)

    def _goals(self) -> Ints:
        """The things that robots are wandering to, [N]; -1 where there is none, or it is gone."""
        goal, known = self.state.goal, self.known()
        return np.where((goal >= 0) & known[np.arange(len(goal)), goal], goal, -1)

    def _in_sight(self) -> Bools:
        """Which known things are in the picture of the head camera now, [N, J]."""
        stack, state, site = self.stack, self.state, self._known_sites()
        off = stack.position[state.scene[:, None], site] - state.place[:, None]
        along = off[..., 0] * np.cos(state.heading)[:, None] + off[..., 1] * np.sin(state.heading)[:, None]
        cosine = along / np.maximum(np.sqrt((off**2).sum(-1)), NO_DISTANCE)
        pixels = stack.pixels[state.scene[:, None], state.stand[:, None], site]
        return self.known() & (cosine >= HALF_VIEW) & (pixels >= SEEN_PIXELS * cosine**3)

    def _site_beside(self, rows: Ints) -> Ints:
        """The sites that are nearest to the robots, of those that can be walked to, [R]."""
        stack, state = self.stack, self.state
        scene = state.scene[rows]
        away = np.sqrt(((stack.position[scene] - state.place[rows][:, None]) ** 2).sum(-1))
        reached = np.isfinite(stack.travel[scene, state.stand[rows]])
        return np.argmin(np.where(reached, away, np.inf), axis=1)
