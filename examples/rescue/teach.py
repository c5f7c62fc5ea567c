"""Record what networks learn from, for learn.py: the benchmark's skills, in whole rescues and from places at things.

Skills demonstrate in rooms of `train`, while noise leads the robot astray; the label of each frame is what the skill
does about it (DART: Laskey et al., CoRL 2017). Later the networks play first, each for a while, then a skill takes over
where that led, and its labels are noted (as in DAgger: Ross et al., AISTATS 2011, but whole ways on, not single steps).
"""

from __future__ import annotations

import math
import sys
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from hazard_ms import Action
from hazard_ms.evaluation.options import EpisodeOptions
from hazard_ms.evaluation.runner import environment, play
from hazard_ms.skills import actions
from hazard_ms.skills.brief import Brief
from hazard_ms.skills.context import Skill, Stage
from hazard_ms.skills.decision import DROP, PICK_UP, Result
from hazard_ms.skills.executor import SkillEnv
from hazard_ms.skills.motor.arm import fold, follow
from hazard_ms.skills.motor.grasping import SHUT_FRAMES
from hazard_ms.skills.motor.motion import turn_by
from hazard_ms.skills.motor.reaching import GRASP, arm_way
from hazard_ms.skills.motor.surface import Place, place_of
from hazard_ms.skills.motor.walking import known

sys.path[:0] = [str(Path(__file__).parent), str(Path(__file__).parents[1])]
import clone_pick_up as reaching  # noqa: E402
from hands import ARM, felt, wanted  # noqa: E402
from policies import VERBS, Deciding, Policies  # noqa: E402
from walks import LOOK, Walk  # noqa: E402

SWERVE, KEPT = 0.7, 0.9  # noise in how fast it turns, as a share of full speed; the share of it left after a frame
ASIDE, AWAY = 1.6, 0.35  # a reach whose base turns [rad] or drives [m] farther is left out: it goes to another place
EVERY, ENDS = 2, 4  # frames of walks of which one is learned from: the next looks the same; times that an end counts
LED = {"walk": 70, "reach": 70, "stow": 40}  # frames that a network plays at most before a skill takes over
NEAR, ROOM = (0.45, 0.75), 0.05  # from the edge of a thing to where the robot is put [m]; to spare around it there [m]
ASKEW = 0.4  # by which it is not turned to the thing there, mostly [rad]
TRIES = 30  # places that are drawn until one is free


class Notes:
    """Frames with labels."""

    def __init__(self) -> None:
        self.walks: list[tuple[np.ndarray, np.ndarray, np.ndarray]] = []  # maps, numbers, label
        self.frames: dict[str, list[reaching.Frame]] = {name: [] for name in ARM}

    def write(self, out: Path) -> None:
        """Write all that was noted so far."""
        made = {f"walk_{part}": np.stack(rows) for part, rows in enumerate(zip(*self.walks, strict=True))}
        for name, rows in self.frames.items():
            made.update({f"{name}_{part}": np.stack(own) for part, own in enumerate(zip(*rows, strict=True))})
        np.savez_compressed(out, **made)

    def __str__(self) -> str:
        return str({"walk": len(self.walks), **{name: len(rows) for name, rows in self.frames.items()}})


class Teacher(Deciding):
    """Moves by the benchmark's skills while noise leads them astray, and notes what they do about it.

    The networks of `pupil`, if there is one, begin each action.
    """

    def __init__(self, seed: int = 0, pupil: Policies | None = None) -> None:
        super().__init__()
        self.chance, self.notes, self.pupil = np.random.default_rng(seed), Notes(), pupil

    def reset(self, brief: Brief) -> None:
        """Begin an episode."""
        super().reset(brief)
        if self.pupil is not None:
            self.pupil.reset(brief)

    def skill(self, stage: Stage, action: Action) -> Skill:
        """The benchmark's skill for `action`, disturbed, after what the pupil does."""
        verb = VERBS.get(action.verb)
        if verb in ("walk", "reach") and action.target in stage.labeller.names:
            return self.taught(stage, action, str(verb), stage.labeller.index(str(action.target)))
        if verb == "stow" and action.target is None and stage.held >= 0:
            return self.taught(stage, action, verb, stage.held)
        return actions.skill(stage, action)

    def taught(self, stage: Stage, action: Action, verb: str, index: int) -> Skill:
        """The `action` as networks begin it and a skill ends it."""
        now, place, led = reaching.PickUp(stage, index), place_of(stage, index), 0
        if self.pupil is not None:
            doing, most = self.pupil.skill(stage, action), int(self.chance.integers(LED[verb]))
            while led < most:
                try:
                    sent = next(doing)
                except StopIteration as over:
                    return over.value
                yield sent
                now.targets, led = np.array(sent[reaching.ARM], np.float64), led + 1
            doing.close()
        if verb == "walk":
            ended = yield from self.swerving(stage, actions.skill(stage, action), index)
            return replace(ended, frames=ended.frames + led)
        stage._arm = now.targets.copy()
        doing = actions.skill(stage, action)
        if led > 0:
            doing = taken(stage, index) if verb == "reach" else put_away(stage, place)
        ended = yield from self.trembling(stage, doing, now, (verb, "stow"))
        return replace(ended, frames=ended.frames + led)

    def swerving(self, stage: Stage, doing: Skill, index: int) -> Skill:
        """A walk that turns more or less than the skill wants."""
        walk, noise, size, results = Walk(stage, index), 0.0, SWERVE * self.chance.random(), list[Result]()
        for used, action in enumerate(noting(doing, results)):
            wanted = action[reaching.BASE].copy()
            if known(stage, index) and used % LOOK == 0:
                walk.plan()
            if known(stage, index) and used % EVERY == 0:
                self.notes.walks.append((walk.maps(), walk.numbers(), np.append(wanted, 0.0).astype(np.float32)))
            noise = KEPT * noise + math.sqrt(1.0 - KEPT**2) * size * self.chance.normal()
            action[reaching.BASE] = np.clip(wanted + (0.0, noise), -1.0, 1.0)
            yield action
        if results[0].ok and known(stage, index):
            self.notes.walks += [(walk.maps(), walk.numbers(), np.array([0.0, 0.0, 1.0], np.float32))] * ENDS
        return results[0]

    def trembling(self, stage: Stage, doing: Skill, now: reaching.PickUp, names: tuple[str, str]) -> Skill:
        """A reach or a stow whose arm goes a little astray; `names`: what frames are of before and while it is held."""
        rows: list[list[reaching.Frame]] = [[], []]
        results = list[Result]()
        noise, size = np.zeros(7), reaching.NOISE * self.chance.uniform(0.0, 1.4)
        for action in noting(doing, results):
            rows[stage.held == now.index].append((felt(now), wanted(now, action)))
            noise = reaching.KEPT * noise + math.sqrt(1.0 - reaching.KEPT**2) * size * self.chance.normal(size=7)
            now.targets = action[reaching.ARM] + noise
            yield np.concatenate([now.targets, action[reaching.GRIPPER :]]).astype(np.float32)
        moved = np.array([seen[26:29] for seen, _ in rows[0]]).reshape(-1, 3)
        if results[0].ok and (np.abs(moved) < (AWAY, AWAY, ASIDE)).all():
            for name, own in zip(names, rows, strict=True):
                self.notes.frames[name] += own
        return results[0]


def noting(doing: Skill, results: list[Result]) -> Skill:
    """The same as `doing`; `results` get what it returns."""
    results.append((yield from doing))
    return results[0]


def taken(stage: Stage, index: int) -> Skill:
    """Take the thing `index` from where base and arm are now, and fold the arm; in the old way if there is no other."""
    way, place = arm_way(stage, index, set(), stage.position(index)), place_of(stage, index)
    if way is None:
        return (yield from actions.skill(stage, Action(PICK_UP, stage.labeller.names[index])))

    def close() -> bool:
        return stage.would_take() == index and stage.gap(index) < GRASP

    used = (yield from turn_by(stage, way.turn)).frames if way.turn else 0
    used += (yield from follow(stage, way.route, close)).frames
    for _ in range(SHUT_FRAMES if close() else 0):
        if stage.held == index:
            break
        yield stage.act(arm=stage._arm, shut=True)
        used += 1
    used += (yield from fold(stage, place)).frames if stage.held == index else 0
    return Result(stage.held == index, frames=used)


def put_away(stage: Stage, place: Place) -> Skill:
    """Bring what is held from where it stood at `place` to the bag, past furniture."""
    used = (yield from fold(stage, place)).frames
    put = yield from actions.skill(stage, Action(DROP))
    return Result(put.ok, put.reason, used + put.frames)


def rescues(teacher: Teacher, out: Path, tasks: list[str], seeds: list[int]) -> None:
    """Let `teacher` play the `seeds`, as of a range, of `tasks` in `train`, and write its notes."""
    for number in range(*seeds):
        for task in tasks:
            result = play(EpisodeOptions(task, split="train", seed=number, effects="off"), player=teacher)
            print(
                f"{task} {number}: {100 * result.tally.value:.0f} % rescued; frames so far: {teacher.notes}", flush=True
            )
    teacher.notes.write(out)


def reaches(teacher: Teacher, out: Path, tasks: list[str], seeds: list[int], each: int) -> None:
    """Let `teacher` take things and put them away, `each` target from so many places around, and write its notes."""
    for task in tasks:
        env = environment(EpisodeOptions(task, split="train", effects="off"))
        for number in range(*seeds):
            env.reset(seed=number)
            here, begin, done = env.stage.robot.base(), env.base.get_state_dict(), list[bool]()
            reaching.stand(env, *here, looks=reaching.LOOKS)
            for name in each * [target.name for target in env.labeller.targets()]:
                if put_beside(env, name, teacher.chance):
                    done += [env.run(teacher.skill(env.stage, Action(PICK_UP, name))).ok]
                    if env.stage.held >= 0:
                        env.run(teacher.skill(env.stage, Action(DROP)))
                reaching.restore(env, begin)
            print(f"{task} {number}: {sum(done)} of {len(done)} taken; frames so far: {teacher.notes}", flush=True)
        env.close()
    teacher.notes.write(out)


def put_beside(env: SkillEnv, name: str, chance: np.random.Generator) -> bool:
    """Put the robot where there is room for it at the target `name`, about turned to it; False where none is found."""
    index, stage = env.labeller.index(name), env.stage
    place, edge = stage.position(index)[:2], stage.labeller.half_width(index)
    height, cells = stage.obstacles(), np.argwhere(stage.obstacles() > ROOM)
    for _ in range(TRIES):
        angle, far = chance.uniform(0.0, math.tau), edge + chance.uniform(*NEAR)
        spot = place - far * np.array([math.cos(angle), math.sin(angle)])
        row, column = np.floor((spot - stage.seen.origin) / stage.seen.cell).astype(int)[::-1]
        inside = 0 <= row < height.shape[0] and 0 <= column < height.shape[1]
        away = (cells[:, ::-1] + 0.5) * stage.seen.cell + stage.seen.origin - spot
        if not inside or not stage.seen.explored[row, column]:
            continue
        if len(away) and np.hypot(*away.T).min() < stage.robot.build.radius + ROOM:
            continue
        reaching.stand(env, *spot, angle + ASKEW * chance.normal(), looks=1)
        return known(stage, index)
    return False


def teacher_of(seed: int, weights: Any) -> Teacher:
    """One whose pupil has the networks in the folder `weights`; without a pupil if that is None."""
    return Teacher(seed, None if weights is None else Policies(str(weights)))
