"""Teams that can be played in the sketch: those of `hazard_ms.agents` under the same names, over options.

They choose for the robot of each rescue that is asked, from what that robot has seen, and from what the team shares.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np

from hazard_ms.sketch.policies import HANDLING, greedy, greedy_without
from hazard_ms.sketch.rescues.scene import Bools, Floats, Ints, SketchScene
from hazard_ms.sketch.skill_times import SkillTimes
from hazard_ms.sketch.teams.world import TeamSketch
from hazard_ms.skills.options.options import END, FIRST, GIVE_UP, LOOK
from hazard_ms.spec.checks import one_of

Policy = Callable[[TeamSketch, np.random.Generator], Ints]


def independent(sketch: TeamSketch, chance: np.random.Generator) -> Ints:
    """The option of the robot that is asked in each rescue, as `greedy` on its own, [N]. Nothing is drawn."""
    return greedy(sketch, chance)[sketch.rows]


def auction(sketch: TeamSketch, chance: np.random.Generator) -> Ints:
    """The option of the robot that is asked in each rescue, as `greedy` among what an auction leaves to it, [N].

    A robot looks around rather than stop while others have targets to fetch. Nothing is drawn.
    """
    del chance
    targets, rows = sketch.saved_at.shape[1], sketch.rows
    left_out = np.zeros((len(sketch.state.frame), targets), bool)
    owner = allocated(sketch)
    left_out[rows] = (owner >= 0) & (owner != sketch.turn[:, None])
    made = greedy_without(sketch, left_out)[rows]
    return np.where((made == FIRST[END]) & left_out[rows].any(axis=1), FIRST[LOOK], made)


POLICIES: dict[str, Policy] = {"independent": independent, "auction": auction}


def allocated(sketch: TeamSketch) -> Ints:
    """The robot to which each target of each rescue goes, [N, T]; -1: nobody bids for it.

    Robots bid how far they will have come when they get to a target that they have seen when they were last asked: each
    target goes to the lowest bid, one after the other. What a robot is on its way to, or holds, stays its own.
    """
    state, robots = sketch.state, sketch.robots
    teams, targets = sketch.saved_at.shape
    scene = state.scene[::robots]
    now = state.frame[sketch.rows][:, None]
    open_ones = ~((sketch.saved_at >= 0) & (sketch.saved_at <= now)) & sketch.stack.there[scene]
    site = sketch.asked_site.reshape(teams, robots, targets)
    spot = sketch.stack.position[scene[:, None, None], site]  # [N, R, T, 2]
    bidding = ~state.over.reshape(teams, robots)
    seen = (site >= 0) & open_ones[:, None] & bidding[..., None]
    able = seen & (state.failures[:, :targets].reshape(site.shape) < GIVE_UP)
    owner, place, way = _aims(sketch, seen, spot)
    while True:
        bids = np.where(able & (owner < 0)[:, None], way[..., None] + _metres(spot - place[:, :, None]), np.inf)
        flat = bids.reshape(teams, -1)
        best = flat.argmin(axis=1)
        team = np.flatnonzero(np.isfinite(flat[np.arange(teams), best]))
        if not len(team):
            return owner
        robot, target = np.divmod(best[team], targets)
        owner[team, target] = robot
        way[team, robot] = flat[team, best[team]] + HANDLING
        place[team, robot] = spot[team, robot, target]


def _aims(sketch: TeamSketch, seen: Bools, spot: Floats) -> tuple[Ints, Floats, Floats]:
    """The owners of what robots are on their way to or hold, [N, T]; where they are after it, and how far that is [m].

    [N, R, 2] and [N, R]; `seen` [N, R, T], at `spot` [N, R, T, 2] [m].
    """
    teams, robots, targets = seen.shape
    aim = sketch.aim.reshape(teams, robots)
    owner = np.full((teams, targets), -1)
    place, way = sketch.asked_place.reshape(teams, robots, 2).copy(), np.zeros((teams, robots))
    for robot in range(robots):
        own = aim[:, robot]
        team = np.flatnonzero(own >= 0)
        owner[team, own[team]] = robot
        known = team[seen[team, robot, own[team]]]
        there = spot[known, robot, own[known]]
        way[known, robot] = _metres(there - place[known, robot]) + HANDLING
        place[known, robot] = there
    return owner, place, way


def _metres(off: Floats) -> Floats:
    return np.asarray(np.sqrt((off**2).sum(-1)))


def play(sketch: TeamSketch, policy: Policy, seed: int = 0) -> None:
    """Play all rescues of `sketch` to their ends; `seed` is that of the policy's own chance."""
    chance = np.random.default_rng(seed)
    while not sketch.over.all():
        sketch.step(policy(sketch, chance))


def mean_values(
    team: str, scenes: Sequence[SketchScene], seeds: Sequence[int], times: SkillTimes, robots: int, trials: int
) -> Floats:
    """The mean Value of `trials` rescues by a team of POLICIES in each of W `scenes`, [W], 0 to 1.

    `seeds` [W] are of these. Raises ValueError for an unknown team, and as `TeamSketch` does.
    """
    policy = POLICIES[one_of(team, POLICIES, "team")]
    rows = np.repeat(np.arange(len(scenes)), trials)
    sketch = TeamSketch(scenes, times, len(rows), robots)
    sketch.reset(rows, np.asarray(seeds)[rows] * trials + np.tile(np.arange(trials), len(scenes)))
    play(sketch, policy)
    return np.asarray(sketch.score.reshape(len(scenes), trials).mean(axis=1))
