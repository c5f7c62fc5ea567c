"""The places of things that the wind carries, for ray-traced pictures: WIND_VERT of shaders/wind.py in numpy."""

from __future__ import annotations

import numpy as np

from hazard_ms.effects.meshes import NOWHERE, unit
from hazard_ms.effects.shaders.common import STREAK
from hazard_ms.effects.shaders.wind import BOX

Array = np.ndarray
SUN = np.array([-0.32, -0.49, 0.81])  # where light comes from, as in shaders/wind.py


def carried(kind: Array, seed: Array, home: Array, pose: Array, eye: Array) -> tuple[Array, Array, Array, Array]:
    """Places [m], edges across and up, [Q, 3] each, and lightness 0..1, [Q], of the copies around `eye` [m], [3].

    `kind` and `seed`, [Q]; `home`: places in the box of air [m], [Q, 3]; `pose`, [4, 4], carries drift and time. What
    does not fly, between two gusts, is far below.
    """
    time, one, two = pose[2, 3], seed * 17.0 % 1.0, seed * 43.0 % 1.0
    heading = pose[:2, 0] / np.linalg.norm(pose[:2, 0])
    streak = kind >= STREAK
    swing = time * (1.1 + 1.3 * two) + 6.28 * one
    at = home[:, :2] + pose[:2, 3] * np.where(streak, 1.0, 0.75 + 0.4 * one)[:, None]
    at += np.where(streak, 0.1, 0.35)[:, None] * np.stack([np.sin(swing), np.cos(0.83 * swing + 2.0 * one)], -1)
    bob = np.where(streak, 0.05, 0.16 + 0.25 * home[:, 2] * two)
    height = home[:, 2] + bob * (1.0 + np.sin(1.37 * swing)) * 0.5
    at = eye[:2] + (at - eye[:2] + 0.5 * BOX) % BOX - 0.5 * BOX
    way = (at - pose[:2, 3]) @ np.column_stack([heading, [-heading[1], heading[0]]])
    front = 0.5 + 0.5 * np.sin(0.42 * way[:, 0] + 1.2 * np.sin(0.23 * way[:, 1]))
    calm = seed * 97.0 % 1.0 > 0.35 + 0.9 * front  # between two gusts
    anchor = np.column_stack([at, np.where(calm, 10.0 * NOWHERE, height)])
    ahead = np.column_stack([np.broadcast_to(heading, at.shape), 0.05 * np.sin(swing)])
    axis = unit(np.column_stack([np.cos(swing * 0.7), np.sin(swing * 0.7), 0.6 * np.sin(swing * 0.31)]))
    side = unit(np.cross(axis, [0.3, 0.5, 0.81]))
    angle = (time * (2.0 + 4.0 * (seed * 53.0 % 1.0)) + 6.28 * (seed * 31.0 % 1.0))[:, None]
    along = np.cross(axis, side) * np.cos(angle) + axis * np.sin(angle)
    across = np.where(streak[:, None], unit(np.cross(ahead, eye - anchor)), side)
    up = np.where(streak[:, None], ahead, along)
    shade = np.where(streak, 1.0, 0.45 + 0.55 * np.abs(np.cross(across, up) @ SUN))
    return anchor, across, up, shade
