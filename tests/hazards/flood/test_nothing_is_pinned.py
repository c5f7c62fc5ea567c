"""In 25 kitchens full of water, what is lighter than water is at its surface, or something holds it."""

from __future__ import annotations

from typing import Any

import gymnasium as gym
import numpy as np
import pytest

import hazard_ms  # noqa: F401 registers the environments
from hazard_ms.hazards.fire.floor import half_spans

pytestmark = [pytest.mark.long, pytest.mark.timeout(1800)]

FRAMES, KITCHENS = 1450, 25
WATER = 1000.0  # density [kg/m^3]
DEEP = 0.1  # distance of its middle below the surface from which on a thing counts as under water [m]
MORE = 0.02  # share of its volume by which a thing that is held is deeper in the water than it floats
NEAR = 0.03  # gap between boxes of bodies that may touch [m]
STOPPED = 5.0  # time for which the water then stands still [s]
RISEN = 0.05  # rise in that time from which on a thing counts as held by the push of the water alone [m]
MOST = 0.03  # share of the light things that may be under water with nothing above them


def test_light_things_float_unless_something_is_above_them() -> None:
    env = gym.make("HazardFlood-v1", obs_mode="none", render_backend="none", physics="realistic")
    base: Any = env.unwrapped
    light, under, beside, pushed, afloat = 0, [], [], [], []
    for number in range(KITCHENS):
        scene = f"kitchen_a/{number:02d}"
        env.reset(seed=number, options={"scene": scene})
        still = np.zeros(env.action_space.shape, np.float32)
        for _ in range(FRAMES):
            env.step(still)
        world, state = base.world, base.episode.states["flood"]
        world.read()
        wet = world.exists[0] & world.movable[0] & (state.fraction[0] > 0.0)
        share = world.mass[0] / (WATER * state.volume[0] * (1.0 - state.pores[0] * state.soaked[0]))
        light += int((wet & (share < 1.0)).sum())
        lifted = wet & (state.fraction[0] > share + MORE)  # by more than its weight, so something holds it
        depth = _depths(base)
        held = (lifted & (depth > DEEP)).nonzero()[:, 0].tolist()
        for thing in held:
            above, touching = _neighbours(world, thing)
            off = (world.agent_position[0, :2] - world.position[0, thing, :2]).norm()
            if off < base.agent.build.radius + float(half_spans(world.rotation, world.extent)[0, thing, :2].norm()):
                touching.append("robot")
            assert touching, (scene, world.names[0][thing])  # water alone holds nothing down
            (under if above else beside).append((scene, world.names[0][thing], above or touching))
        _let_the_water_stand(env, state, still)
        risen = depth - _depths(base)
        pushed += [(scene, world.names[0][thing]) for thing in held if risen[thing] > RISEN]
        for thing in (thing for thing in held if risen[thing] <= RISEN):
            if state.fraction[0, thing] <= share[thing] + MORE:  # it is large, or nearly as heavy as water
                afloat.append((scene, world.names[0][thing]))
            else:
                assert _neighbours(world, thing)[1], (scene, world.names[0][thing])  # something solid holds it
    env.close()
    print(f"\n{light} light wet things, {len(under)} held down under something, {len(beside)} beside something")
    print(f"when the water stood still, {len(pushed)} of them came up, {len(afloat)} were as deep as they float")
    print(*under, *beside, "came up:", *pushed, "afloat:", *afloat, sep="\n")
    assert light > 10 * KITCHENS
    assert len(beside) <= MOST * light


def _let_the_water_stand(env: Any, state: Any, action: np.ndarray) -> None:
    """Play STOPPED seconds in which the water has no speed."""
    for _ in range(round(STOPPED / env.unwrapped.control_timestep)):
        for quantity in (state.velocity_x, state.velocity_y, state.discharge_x, state.discharge_y):
            quantity.zero_()
        env.step(action)
    env.unwrapped.world.read()


def _depths(base: Any) -> Any:
    """Depths of the middles of the things below the surface [m], [B]."""
    world, state = base.world, base.episode.states["flood"]
    return base.task.hazards[0].image(state, world, world.position)[0] - world.position[0, :, 2]


def _neighbours(world: Any, thing: int) -> tuple[list[str], list[str]]:
    """Names of the bodies that touch a thing and reach above its middle, and of all that touch it.

    Bodies are boxes along the axes, so what is caught between the legs of a table counts as under it.
    """
    half = half_spans(world.rotation, world.extent)[0]
    gap = (world.position[0] - world.position[0, thing]).abs() - half - half[thing]
    there = world.exists[0] & ~world.away[0] & (gap < NEAR).all(-1)
    there[thing] = False
    over = there & (gap[:, :2] < 0.0).all(-1) & (world.position[0, :, 2] + half[:, 2] > world.position[0, thing, 2])
    above, all_of_them = ([world.names[0][k] for k in found.nonzero()[:, 0].tolist()] for found in (over, there))
    return above, all_of_them
