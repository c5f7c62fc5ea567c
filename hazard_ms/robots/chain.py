"""Places of links along an arm for many postures at once, by a compiled kernel.

The frames are those of the description that SAPIEN hands to pinocchio, which takes forty times as long for a posture.
They are composed in the same order and with the same precision, so that places are the same.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any
from xml.etree import ElementTree

import numpy as np
import torch
import warp as wp
from numpy.typing import NDArray

from hazard_ms.simulation.kernels.launch import OPTIONS, Launches
from hazard_ms.spec.undocumented import export_kinematic_chain_xml

wp.set_module_options(OPTIONS)

MOST = 256  # postures for which there is room at first


@wp.kernel
def follow(
    slides: wp.array(dtype=wp.bool),
    columns: wp.array(dtype=wp.int32),
    numbers: wp.array(dtype=wp.int32),
    turns: wp.array(dtype=wp.mat33d),
    shifts: wp.array(dtype=wp.vec3d),
    links: wp.array(dtype=wp.vec3d),
    joints: wp.array2d(dtype=wp.float64),
    places: wp.array2d(dtype=wp.vec3),
):
    """Note the `places`, [N, P] [m], of links if all joints were at `joints`, [N, Joints] [rad] or [m].

    The chain has K joints, which turn about their x axes, or slide along them: `columns` of each in `joints`; `turns`
    and `shifts` [m] from its frame to that before. `numbers`: that of the place to note, or -1, which is at `links` [m]
    in the joint's frame.
    """
    posture = wp.tid()
    turn = wp.identity(n=3, dtype=wp.float64)
    place = wp.vec3d()
    for k in range(columns.shape[0]):
        at, none, one = joints[posture, columns[k]], wp.float64(0.0), wp.float64(1.0)
        slid, bent = wp.where(slides[k], at, none), wp.where(slides[k], none, at)
        c, s = wp.cos(bent), wp.sin(bent)
        frame = turns[k]
        shift = shifts[k] + slid * wp.vec3d(frame[0, 0], frame[1, 0], frame[2, 0])
        place = place + turn * shift
        turn = turn * (frame * wp.mat33d(one, none, none, none, c, -s, none, s, c))
        if numbers[k] >= 0:
            there = place + turn * links[k]
            places[posture, numbers[k]] = wp.vec3(wp.float32(there[0]), wp.float32(there[1]), wp.float32(there[2]))


class Chain:
    """The joints from a robot's root to the last of some links, each of which hangs on one of these joints."""

    def __init__(self, articulation: Any, links: Sequence[int]) -> None:
        """Read SAPIEN's `articulation`; `links`: the numbers of P links among its own, in any order."""
        order = [joint.child_link.index for joint in articulation.active_joints]
        path = _path(export_kinematic_chain_xml(articulation), max(links, key=lambda n: _depth(articulation, n)))
        slides, columns, numbers, frames, ends = [], [], [], [], []
        frame = np.eye(4)
        for number, kind, joint, link in path:
            frame = frame @ joint
            if kind != "fixed":
                slides.append(kind == "prismatic")
                columns.append(order.index(number))
                numbers.append(-1)
                frames.append(frame)
                ends.append(np.zeros(3))
                frame = np.eye(4)
            frame = frame @ link
            if number in links:
                numbers[-1], ends[-1] = list(links).index(number), frame[:3, 3]
        self._fixed = (
            torch.tensor(slides),
            torch.tensor(columns, dtype=torch.int32),
            torch.tensor(numbers, dtype=torch.int32),
            torch.from_numpy(np.ascontiguousarray(np.array(frames)[:, :3, :3])),
            torch.from_numpy(np.ascontiguousarray(np.array(frames)[:, :3, 3])),
            torch.from_numpy(np.array(ends)),
        )
        self._launches = Launches()
        self._joints = torch.empty((MOST, len(order)), dtype=torch.float64)
        self._places = torch.empty((MOST, len(links), 3), dtype=torch.float32)

    def places(self, joints: NDArray[np.float64], moving: list[int], arms: NDArray[np.float64]) -> NDArray[np.float64]:
        """Places of the links [m], [N, P, 3], in the root's frame, if the J joints `moving` were at `arms`, [N, J].

        All others are at `joints`, [Joints]; [rad] or [m].
        """
        count = len(arms)
        if count > len(self._joints):
            self._joints = self._joints.new_empty(count, self._joints.shape[1])
            self._places = self._places.new_empty(count, *self._places.shape[1:])
        rows = self._joints.numpy()[:count]
        rows[:] = joints
        rows[:, moving] = arms
        self._launches.run(follow, (count,), *self._fixed, self._joints, self._places)
        return self._places.numpy()[:count].astype(np.float64)


def _depth(articulation: Any, link: int) -> int:
    """Number of joints between the root and the link of this number."""
    return len(list(_path(export_kinematic_chain_xml(articulation), link)))


def _path(
    description: ElementTree.Element, link: int
) -> list[tuple[int, str, NDArray[np.float64], NDArray[np.float64]]]:
    """From the root to `link`: the number of each link, the kind of its joint, and the frames of both.

    The joint's frame is in that of the link before, the link's in that of its joint; [4, 4] [m].
    """
    joints = {joint.attrib["name"]: joint for joint in description.iter("joint")}
    found: list[tuple[int, str, NDArray[np.float64], NDArray[np.float64]]] = []
    while True:
        joint, fixed = joints[f"joint_{link}"], joints.get(f"joint_dummy_{link}")
        if fixed is None:
            return found[::-1]
        found.append((link, joint.attrib["type"], _frame(joint), _frame(fixed)))
        link = int(_of(joint, "parent").attrib["link"].removeprefix("link_"))


def _frame(joint: ElementTree.Element) -> NDArray[np.float64]:
    """The frame, [4, 4] [m], of a joint: the turn goes by a quaternion, as in readers of these descriptions."""
    origin = _of(joint, "origin").attrib
    (a, d), (b, e), (c, f) = ((np.cos(float(t) / 2), np.sin(float(t) / 2)) for t in origin["rpy"].split())
    quaternion = np.array([a * b * c + d * e * f, d * b * c - a * e * f, a * e * c + d * b * f, a * b * f - d * e * c])
    w, x, y, z = quaternion / np.linalg.norm(quaternion)
    frame = np.eye(4)
    frame[:3, :3] = [
        [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
        [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
        [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
    ]
    frame[:3, 3] = [float(t) for t in origin["xyz"].split()]
    return frame


def _of(joint: ElementTree.Element, part: str) -> ElementTree.Element:
    found = joint.find(part)
    assert found is not None  # SAPIEN writes both for each joint but that of the root
    return found
