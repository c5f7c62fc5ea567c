"""A watcher that judges every decision of an episode, while it is played or simulated again, by what is hidden."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from hazard_ms.agents.action_values import Notion, mean
from hazard_ms.agents.judge import Judge
from hazard_ms.evaluation.metrics import Tally
from hazard_ms.evaluation.regret.causes import LATENCY, LEAST, MEMORY, MITIGATION, PERCEPTION, Appraisal, Without
from hazard_ms.evaluation.regret.identities import Identities, Meant
from hazard_ms.evaluation.regret.judged import Judged
from hazard_ms.evaluation.regret.measures import MeasureWorth
from hazard_ms.evaluation.result import Played
from hazard_ms.evaluation.runner import fates
from hazard_ms.evaluation.watchers import Watcher
from hazard_ms.sensing.view import View
from hazard_ms.skills.decision import NEED_TARGET, Action, Decision, Result
from hazard_ms.skills.executor import SkillEnv
from hazard_ms.spec.catalogue import CATEGORIES

CLEAR = 30  # pixels from which a target in view must be noticed
OFF = 0.5  # from this distance to its true place on, a target's place in the map is wrong [m]
NAMED = 3  # targets that evidence names [ours]


class Known(NamedTuple):
    """A target as the map of a decision holds it."""

    category: str
    place: tuple[float, float]  # x, y [m]


class Appraiser(Watcher):
    """Judges the first `count` decisions of an episode, all if None; it changes nothing.

    appraisals   one for each decision
    bests        value that the best plan reached when the agent was asked, each time, as a share of all
    value        share that was rescued in the end
    averts       whether shares are of what is not lost when time is up, as in homes, and plans have measures
    """

    def __init__(self, count: int | None = None, mind: Callable[[SkillEnv], Judge] = Judge, told: bool = False) -> None:
        """`count`: see above; `mind` makes the judge; `told`: whether the agent knows of all fires and tools."""
        self._count, self._made, self._told_all, self.averts = count, mind, told, False
        self.appraisals: list[Appraisal] = []
        self.bests: list[float] = []
        self.value = 0.0

    def begin(self, env: SkillEnv, decision: Decision) -> None:
        """Take the environment, and notice from now on what each look shows."""
        self._env, self._mind = env, self._made(env)
        self._total = sum(self._mind.truth.values.values())
        self.averts = self._mind.aim.averts
        self._worth = MeasureWorth(env, self._mind) if self.averts else None
        self._clear: dict[int, str] = {}  # targets that were clearly in view, and how
        self._held_once: set[int] = set()  # targets that the map of a decision once held
        self._identities = Identities(env)
        self._notice(env.base.observer.glance(), env.frame)  # as the first look was, which is over
        view, look = env.labeller.view, env.stage.look

        def viewed(rgb: NDArray[np.uint8] | None, true: View, frame: int) -> View:
            self._notice(true, frame)
            return view(rgb, true, frame)

        def looked() -> None:
            look()
            self._identities.looked()

        env.labeller.view = viewed  # type: ignore[method-assign]
        env.stage.look = looked

    def _notice(self, true: View, frame: int) -> None:
        """Note which targets are clearly in view, by its `true` labels."""
        assert true.labels is not None
        shown = true.labels[(true.labels >= 0) & (true.depth > 0.0)]
        for index, pixels in enumerate(np.bincount(shown).tolist()):
            if index in self._mind.targets and index not in self._clear and pixels >= CLEAR:
                self._clear[index] = f"was in view with {pixels} pixels at frame {frame}"

    def asked(self, so_far: Played) -> None:
        """Work out what the best plan reaches from here."""
        self._identities.looked()  # after the look that ends an action
        self._state = self._mind.state()
        plain = mean(self._mind.best(self._state, self._mind.limits(self._state)))
        self._gain = 0.0 if self._worth is None else self._worth.gain(self._state, plain)
        self._helps = "" if self._worth is None else ", ".join(self._worth.names)
        self._best = plain + self._gain
        self.bests.append(self._best / self._total)

    def decided(self, decision: Decision, action: Action, note: str) -> None:
        """Judge the choice; `note` is not looked at."""
        meant = self._identities.meant(action)
        self._action = meant.action
        if len(self.appraisals) == self._count:
            return
        now = self._state if self._env.frame == decision.frame else self._mind.state()
        judged = Judged(self._mind, self._state, now, meant, self._total)
        known = self._known(decision)
        regret = judged.regret(self._mind.truth)
        seen, without, instead = regret, {}, ""
        if regret > LEAST:
            seen = min(regret, judged.regret(judged.only({*known, *self._clear, *self._held_once})))
        if seen > LEAST:
            without, instead = self._without(judged, known), judged.instead()
        self._held_once |= set(known)
        if self._worth is not None:
            regret, seen, without = self._with_measures(judged, decision, self._worth, regret, seen, without)
        best, mistaken = self._best / self._total, self._mistaken(decision, action, meant)
        self.appraisals.append(
            Appraisal(decision.frame, action.verb, action.target, best, regret, seen, without, instead, mistaken)
        )

    def _with_measures(
        self,
        judged: Judged,
        decision: Decision,
        worth: MeasureWorth,
        plain: float,
        seen: float,
        without: dict[str, Without],
    ) -> tuple[float, float, dict[str, Without]]:
        """The regret where plans have measures, that among what had been seen, and that without what went wrong.

        `plain`, `seen` and `without` are the same by rescues alone.
        """
        best = self._best - self._gain
        left = max(best - plain * self._total, judged.reached(worth, best))
        regret = max(0.0, self._best - left) / self._total
        if regret <= LEAST:
            return regret, regret, {}
        if worth.is_measure(self._action):
            what = f"{self._action} was done about the hazard, where something else averts more"
            return regret, regret, {MITIGATION: Without(0.0, what)}
        extra = max(0.0, regret - plain)
        if not self._told_all:  # what nobody could know of is unseen
            extra = min(extra, worth.gain(judged.seen, best, decision) / self._total)
        made = {cause: Without(one.regret + extra, one.what) for cause, one in without.items()}
        made[MITIGATION] = Without(seen, f"nothing was done about the hazard, where it helps to {self._helps}")
        return regret, min(regret, seen + extra), made

    def _mistaken(self, decision: Decision, action: Action, meant: Meant) -> str:
        """What the target of an action really is, in words, where it was taken for something to rescue and is not."""
        wanted = action.verb in NEED_TARGET and any(t.name == action.target for t in decision.targets)
        if not wanted or meant.body in self._mind.targets:
            return ""
        what = "nothing that can be carried" if meant.body < 0 else self._env.base.world.names[0][meant.body]
        return f"{action.target} is {what}"

    def _known(self, decision: Decision) -> dict[int, Known]:
        """The targets that the agent knew of."""
        objects = decision.map.objects
        found = [(self._identities.body(t.index), t, objects[t.index]) for t in decision.targets if t.index in objects]
        return {
            body: Known(target.category, (float(seen.position[0]), float(seen.position[1])))
            for body, target, seen in found
            if body in self._mind.targets
        }

    def _without(self, judged: Judged, known: dict[int, Known]) -> dict[str, Without]:
        """What the choice would have lost without each thing that went wrong before it."""
        left = [index for index in judged.seen.left if index != judged.seen.holding]
        unknown = [b for b in left if b in self._clear and b not in known and b not in self._held_once]
        missed = {b: f"{self._clear[b]} and is not in the map" for b in unknown}
        for index, target in self._mind.targets.items():
            if index in left and index in known and known[index].category != target.category:
                missed[index] = f"counts as a {known[index].category}"
        gone = [b for b in left if b in self._held_once and b not in known]
        off = {b: known[b].place for b in left if b in known and self._error(b, known[b]) > OFF}
        told = {b: self._told(b, known[b]) for b in left if b in known}
        if judged.seen.holding is not None:
            told[judged.seen.holding] = self._mind.truth.values[judged.seen.holding]
        made = {}
        if missed:
            kept = {b: self._mind.truth.values[b] for b in gone}
            words = [f"{self._name(b)} {how}" for b, how in missed.items()]
            made[PERCEPTION] = Without(judged.regret(Notion(told | kept)), _list(words))
        if gone or off:
            words = [f"{self._name(b)} is no longer in the map" for b in gone]
            words += [f"{self._name(b)} is {self._error(b, known[b]):.1f} m from where the map has it" for b in off]
            made[MEMORY] = Without(judged.regret(Notion(told, off)), _list(words))
        if judged.waited:
            made[LATENCY] = Without(judged.at_once(), f"the agent took {judged.waited} frames to choose")
        return made

    def _told(self, index: int, known: Known) -> float:
        """The value of a target as the map has it: its own, or that of the category that it is taken for."""
        if known.category == self._mind.targets[index].category:
            return self._mind.truth.values[index]
        return float(CATEGORIES[known.category].value)

    def _name(self, index: int) -> str:
        return self._mind.targets[index].name

    def _error(self, index: int, known: Known) -> float:
        """Distance between the place of a target in the map and the true one [m]."""
        return math.dist(known.place, self._mind.place(index).tolist())

    def ended(self, result: Result) -> None:
        """Note how the action went."""
        self._mind.note(self._action, result)
        if self._worth is not None:
            self._worth.note(self._action, result)

    def finish(self, reason: str) -> None:
        """Note what was rescued, or is not lost if nobody acts any more."""
        self.value = self._mind.state().saved / self._total if self.averts else Tally.of(fates(self._env)).value


def _list(words: list[str]) -> str:
    """Sentences in one, the first few of them."""
    more = [f"{len(words) - NAMED} more"] if len(words) > NAMED else []
    return ", ".join([*words[:NAMED], *more])
