"""The oracle: a reference for what an agent could reach with the skills that all share.

It alone sees what is hidden: where everything is, what is damaged, and what will happen (hazard_ms.sketch.recording).
At each decision it plans by the exact search of `sketch/planning`, enters into its map where things really are, and
acts by ordinary skills, so that what fails in their execution fails for the oracle, too. With `known=true` it plans
only with what its map holds, and searches when that is all done: the difference between the two is what it costs not
to know. Where a gale blows it rescues what that will carry off, into carts or into the lee (hazard_ms.agents.gale).
"""

from __future__ import annotations

import numpy as np

from hazard_ms.agents.attempts import Attempts, Enclosure, Repeats
from hazard_ms.agents.base import PrivilegedAgent
from hazard_ms.agents.gale.carts import PUSH
from hazard_ms.agents.gale.truth import GaleTruth, hazard_of
from hazard_ms.agents.mitigating.doing import Mitigator
from hazard_ms.agents.search.landmark_search import LandmarkSearch
from hazard_ms.agents.search.outlook import SPREAD
from hazard_ms.agents.truth import Truth
from hazard_ms.hazards.base import pushes
from hazard_ms.sketch.planning.averting import averting
from hazard_ms.sketch.planning.orienteering import solve
from hazard_ms.sketch.planning.problem import PlannedRescue, Problem, soonest
from hazard_ms.sketch.rescue_problem import Outset, RescueScene
from hazard_ms.skills.brief import Brief
from hazard_ms.skills.decision import DROP, EXPLORE, PICK_UP, STOP, WALK_ONE_STEP, WALK_TO, Action, Decision
from hazard_ms.skills.executor import SkillEnv
from hazard_ms.skills.failures import UNREACHABLE
from hazard_ms.skills.motor.walking import ARRIVED, MIDPOINT

MOST_REACH = 2.0  # distance up to which it reaches for a thing after a walk has arrived [m] [ours]
NEAR = 0.2  # beyond where a walk arrives, from which it reaches for a thing without walking [m] [ours]
NEAR_CART = 0.7  # beyond where a walk arrives, from which a drop drives on while the arm unfolds [m] [ours]
PROGRESS = 0.2  # a walk that got it this far is not a failure [m]
GIVE_UP, CART_FAILURES = 3, 3  # failures after which a target is left for the end, and a cart no longer used [ours]
FADING = 2e-4  # share of a target's value that is at risk in each frame until it is safe: skills fail [ours]
MOVED = 0.2  # a thing that will be met farther than this from where it is now is moving [m] [ours]
LOYALTY = 20.0  # frames that it deducts for the target that it is on its way to, so that it does not waver [ours]
LOYALTY_ADRIFT = 200.0  # the same in floods of homes, where what drifts past bars ways for a while [ours]
ROUNDS = 2  # number of times that it tries again what it had given up [ours]
MOST_LABELS, BEAM = 20_000, 2_000  # of the exact search: rarely needed; of a layer beyond that [ours]


class Oracle(PrivilegedAgent):
    """Plans with the true future and acts by ordinary skills."""

    colours = False

    def __init__(self, known: bool = False, mitigate: bool = True) -> None:
        """`known`: it plans only with the targets and carts that its map holds; `mitigate`: it uses mitigations."""
        self._only_known, self._mitigates = known, mitigate and not known
        self._truth: Truth | None = None

    def attach(self, env: SkillEnv) -> None:
        """Take the environment, whose map is told the truth from now on."""
        self._truth = Truth(env, self._only_known)

    def reset(self, brief: Brief) -> None:
        """Begin an episode. Nothing is random. Raises ValueError where `attach` was not called before."""
        if self._truth is None:
            raise ValueError("an environment must be attached to the oracle before its reset, got none")
        base = self._truth.env.base
        self._scene = RescueScene(base.specs[0], brief.robot, brief.radius, brief.max_frames)
        self._carts = np.array([base.world.index(0, name) for name in brief.containers], np.int64)
        self._attempts = Attempts()
        self._goal: str | None = None
        self._before: tuple[Action, tuple[float, float]] | None = None  # the last action, and where it began [m]
        self._search = LandmarkSearch()
        gale = hazard_of(base)
        self._gale = None if gale is None else GaleTruth(base, gale, self._scene, self._mitigates)
        self._truth.furniture = gale is not None
        self._loyalty = LOYALTY_ADRIFT if brief.several_rooms and pushes(base.task.hazards) else LOYALTY
        self._mitigator = Mitigator(self._truth, brief) if self._mitigates and brief.mitigations and not gale else None
        self._verb, self._enclosure, self._repeats = brief.mitigation, Enclosure(), Repeats(bool(brief.mitigations))

    def act(self, decision: Decision) -> Action:
        """The next action: the first step of the best plan from here on."""
        assert self._truth is not None
        if self._before is None:  # not earlier: who records the episode begins with the map of an honest agent
            decision = self._truth.furnish(decision)
        if (mitigation := self.asked(decision, self._verb)) is not None:
            return mitigation
        if self._mitigator is not None:
            self._scene = self._mitigator.scene(self._scene, decision.agent_position)
        if self._mitigator is None or not self._mitigator.took(decision):
            self._judge(decision, self._truth)
        self._attempts.in_vain = self._in_vain(decision, self._truth)
        action = self._next(decision, self._truth)
        if (other := self._repeats.instead(decision, action)) is not None:
            action = self._say(self._repeats.note, other)
        self._before = (action, decision.agent_position)
        self._truth.reveal()
        return action

    def _next(self, decision: Decision, truth: Truth) -> Action:
        if not self._enclosure.noticed(decision):
            return self._choose(decision, truth)
        door = self._mitigator and self._mitigator.way_out(decision)
        return self._say("no way leads anywhere", door or Action(EXPLORE))

    def _choose(self, decision: Decision, truth: Truth) -> Action:
        tool = any(t.held for t in decision.tools)
        if decision.held is not None and not decision.containers and not tool:
            return self._say("into the bag", Action(DROP))
        begun = self._mitigator and self._mitigator.go_on(decision, self._scene)
        if self._mitigator and begun:
            return self._say(self._mitigator.note, begun)
        targets, problem = self._problem(decision, truth)  # not earlier: measures change the future
        if self._mitigator is not None and problem is not None:
            action = self._mitigator.act(decision, problem, targets, self._scene)
            if action is not None:
                return self._say(self._mitigator.note, action)
        if tool:
            return self._say("it is of no use any more", Action(DROP))
        if problem is None or (step := self._next_rescue(decision, truth, targets, problem)) is None:
            return self._otherwise(decision, truth)
        self._search.leave()
        measure = self._gale and self._gale.measure(decision, problem, self._carts, self._attempts.failures)
        if self._gale and measure:
            return self._say(self._gale.note, measure)
        holding = decision.held is not None
        index = self._cart(decision, step.cart) if holding else self._arrived_at(decision, truth, step.target)
        name = self._goal = decision.names[index]
        if self._is_near(decision, truth, index):
            return Action(DROP if holding else PICK_UP, name)
        future = truth.future() if self._gale is None else self._gale.future(truth.record())
        met = future.position_at(step.met)[index]
        moves = float(np.linalg.norm(met - truth.position(index))) > MOVED
        truth.aim = {index: met} if moves and decision.walked_up_to != name else {}
        one_step = Action(WALK_ONE_STEP, name)
        nearly = holding and decision.last_action != one_step and self._is_near(decision, truth, index, MIDPOINT)
        return one_step if nearly else Action(WALK_TO, name)

    def _problem(self, decision: Decision, truth: Truth) -> tuple[list[int], Problem | None]:
        """The targets of the next plan, by index along B, and its problem; None where nothing can be rescued."""
        targets = [t for t in decision.targets if t.held or self._considered(t.name, t.index, truth, GIVE_UP)]
        targets = [t for t in targets if not t.rescued and (t.held or t.name not in self._attempts.in_vain)]
        if self._gale is not None:
            stake = self._gale.at_stake(truth.record())
            targets = [t for t in targets if stake[t.index]]
        if not targets or (decision.containers and not self._usable(decision, truth)):
            return [], None
        held, here = next((t.index for t in targets if t.held), None), decision.agent_position
        told = (
            np.array([t.index for t in targets], np.int64),
            np.array([t.value * self._attempts.chance(t.name, here, t.name == self._goal) for t in targets]),
            np.array(self._usable(decision, truth), np.int64),
            Outset(here, decision.agent_heading, decision.frame, held),
            truth.detours(decision, self._scene, [t.index for t in targets])
            - [self._loyalty * (t.name == self._goal) for t in targets],
            FADING,
            SPREAD,
        )
        if self._gale is not None:
            return [t.index for t in targets], self._gale.problem(truth.record(), *told)
        carried_off = truth.env.base.task.averted and pushes(truth.env.base.task.hazards)
        return [t.index for t in targets], self._scene.problem(truth.future(), *told, carried_off)

    def _next_rescue(
        self, decision: Decision, truth: Truth, targets: list[int], problem: Problem
    ) -> PlannedRescue | None:
        """The first step of the best plan, with indices along B for targets; None where nothing can be rescued."""
        aimed = averting(problem) if truth.env.base.task.averted and self._gale is None else problem
        plan = solve(aimed, MOST_LABELS, BEAM)
        self.note = f"plan of {plan.value:g} in {len(plan.rescues)} rescues by frame {plan.frame:.0f}"
        first = plan.rescues[0] if plan.rescues else soonest(problem)
        if first is None:
            return None
        self.note = self.note if plan.rescues else "too late by any plan, but the nearest"
        carts = self._usable(decision, truth)
        used = min(first.cart, len(carts) - 1)  # sites in the lee have the numbers beyond the carts
        cart = int(np.flatnonzero(self._carts == carts[used])[0]) if decision.containers else -1
        return first._replace(target=targets[first.target], cart=cart)

    def _usable(self, decision: Decision, truth: Truth) -> list[int]:
        """The carts that did not fail too often, by index along B."""
        return [int(c) for c in self._carts if self._considered(decision.names[c], int(c), truth, CART_FAILURES)]

    def _cart(self, decision: Decision, planned: int) -> int:
        """The cart that it is on its way to, so that it does not waver, else the planned one; indices along B."""
        under_way = [c for c in self._carts if decision.names[c] == self._goal]
        return int((under_way or [self._carts[planned]])[0])

    def _considered(self, name: str, index: int, truth: Truth, most: int) -> bool:
        """Whether a thing is part of the plan: it failed fewer than `most` times and, if that counts, it is known."""
        return truth.knows(index) and self._attempts.failures.get(name, 0) < most

    def _in_vain(self, decision: Decision, truth: Truth) -> dict[str, tuple[float, ...]]:
        """The targets for which reaching failed at once, and where, if neither they nor the robot moved since."""
        gaps = {n: np.subtract(self._places(decision, truth, n), at) for n, at in self._attempts.in_vain.items()}
        return {n: self._attempts.in_vain[n] for n, gap in gaps.items() if float(np.abs(gap).max()) <= MOVED}

    def _places(self, decision: Decision, truth: Truth, name: str) -> tuple[float, ...]:
        """Where the robot and a thing are [m]."""
        return (*decision.agent_position, *truth.position(decision.index(name))[:2].tolist())

    def _is_near(self, decision: Decision, truth: Truth, index: int, ahead: float = 0.0) -> bool:
        """Whether to reach for a thing from `ahead` [m] of here: a walk has arrived, or soon would; nothing failed."""
        away = float(np.hypot(*(truth.position(index)[:2] - decision.agent_position)))
        name = decision.names[index]
        if decision.walked_up_to == name:
            return away <= MOST_REACH
        near = ARRIVED + self._scene.edges[index] + (NEAR if decision.held is None else NEAR_CART)
        return not self._attempts.failures.get(name, 0) and away - ahead <= near

    def _arrived_at(self, decision: Decision, truth: Truth, planned: int) -> int:
        """The target that it has just walked up to, since it is there now, else the planned one; indices along B."""
        name = decision.walked_up_to
        for target in decision.targets:
            if target.name == name and not target.rescued and self._is_near(decision, truth, target.index):
                return target.index
        return planned

    def _judge(self, decision: Decision, truth: Truth) -> None:
        """Count a failure of the last action, unless it was a walk that came further."""
        if self._before is None or decision.last_result is None:
            return
        action, start = self._before
        stuck = action.verb == WALK_TO and not decision.last_result.frames  # it came to where the thing no longer is
        if decision.last_result.ok and not (stuck and decision.walked_up_to is not None and truth.aim):
            return
        moved = float(np.hypot(*np.subtract(decision.agent_position, start)))
        walked = action.verb in (WALK_TO, WALK_ONE_STEP) and moved > PROGRESS
        if action.target is None or action.verb == PUSH or walked:
            return
        self._attempts.failures[action.target] = self._attempts.failures.get(action.target, 0) + 1
        if decision.last_result.reason == UNREACHABLE and not decision.last_result.frames:
            self._attempts.in_vain[action.target] = self._places(decision, truth, action.target)
        self._attempts.missed[action.target] = decision.agent_position
        self._goal = None

    def _otherwise(self, decision: Decision, truth: Truth) -> Action:
        """The action where no plan rescues anything: search, try again what was given up, or stop."""
        if all(target.rescued for target in decision.targets):
            return self._say("every target is rescued", Action(STOP))
        if self._only_known and (action := self._search.act(decision, self._attempts)) is not None:
            return self._say(self._search.note, action)
        if self._attempts.failures and self._attempts.rounds < ROUNDS:
            self._attempts = Attempts(rounds=self._attempts.rounds + 1, looked=True, in_vain=self._attempts.in_vain)
            if self._only_known:
                return self._say("try again what was given up", Action(EXPLORE))
            return self._choose(decision, truth)
        return self._say("nothing can be rescued any more", Action(STOP))

    def _say(self, note: str, action: Action) -> Action:
        self.note = note
        return action
