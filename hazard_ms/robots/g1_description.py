"""The G1's description (URDF), derived at run time from that of the installed ManiSkill: we ship no files of others.

ManiSkill's upper body stands on legs that are fixed. Ours gets, below the pelvis, a base that moves in the plane and
legs that crouch:

    root - x - y - turn - base - crouch - hips - bend - pelvis (torso, arms and head as they were)
                                          hips - hip pitch - knee - ankle pitch, of both legs

and collision bodies for legs and pelvis, which the installed description lacks. The file is kept in the user's cache
under a hash of its text, so another ManiSkill makes another file.
"""

from __future__ import annotations

from functools import cache
from pathlib import Path
from xml.etree import ElementTree
from xml.etree.ElementTree import Element, SubElement

from hazard_ms.robots.without_visuals import without_visuals
from hazard_ms.spec.storage.cache import kept_folder

LEG_JOINTS = tuple(
    f"{side}_{part}_joint" for side in ("left", "right") for part in ("hip_pitch", "knee", "ankle_pitch")
)
HIP = 0.1027  # the hips' axis lies this far below the pelvis's origin [m] (the installed URDF)
HIP_HEIGHT = 0.6523  # of the hips' axis above the floor, standing [m] (the installed URDF: sole to axis)
DOWN = (-0.28, 0.0, -0.96)  # the way of the hips in a crouch: back, too, so that ankles stay within their limits [ours]
DEEPEST = 0.34  # the hips go this far along it [m] [ours]
BOW = 1.1  # the upper body bends forward this far [rad] [ours]; upright thighs and the hips' limit would allow 2.0
# cylinder for both legs: radius, lower and upper end above the floor [m] [ours]; the feet are 0.20 long
LEGS = (0.20, 0.02, 0.62)
PELVIS = (0.16, 0.20)  # cylinder around pelvis and hips: radius and length [m] [ours]
FAR = 1000.0  # the base may go anywhere [m]
SMALL_MASS = 0.2  # of links that only connect joints [kg], besides the robot's 33 kg [ours]


class UnknownDescriptionError(RuntimeError):
    """Raised if the installed robot is not the one that we know how to put on its legs."""


@cache
def g1_description(installed: Path, bare: bool = False) -> Path:
    """Our G1, made of the `installed` URDF; meshes stay where they are.

    `bare`: without its looks, for where nothing draws.
    """
    robot = ElementTree.parse(installed).getroot()
    for mesh in robot.iter("mesh"):
        mesh.set("filename", str((installed.parent / mesh.get("filename", "")).resolve()))
    _free_the_legs(robot)
    _put_on_a_base(robot)
    text = ElementTree.tostring(robot, encoding="unicode")
    made = kept_folder("robots", {installed.name: text}) / installed.name
    return without_visuals(made) if bare else made


def _free_the_legs(robot: Element) -> None:
    """Let hips, knees and ankles turn, as their limits in the installed file say; hang the legs on the link `hips`."""
    joints = {joint.get("name", ""): joint for joint in robot.findall("joint")}
    missing = [name for name in LEG_JOINTS if name not in joints or joints[name].find("limit") is None]
    if missing:
        raise UnknownDescriptionError(
            f"ManiSkill's G1 has no {', '.join(missing)}; hazard_ms knows the one of ManiSkill 3.0.1"
        )
    for name in LEG_JOINTS:
        joint = joints[name]
        joint.set("type", "revolute")
        if "hip" in name:
            parent, origin = joint.find("parent"), joint.find("origin")
            assert parent is not None and origin is not None
            parent.set("link", "hips")
            x, y, z = (float(v) for v in origin.get("xyz", "").split())
            origin.set("xyz", f"{x} {y} {round(z + HIP, 6)}")


def _put_on_a_base(robot: Element) -> None:
    """Put base, crouch and bend before the pelvis."""
    radius, low, high = LEGS
    names = ("root", "root_arm_1_link_1", "root_arm_1_link_2", "base_link", "hips", "waist")
    links = {name: _link(name) for name in names}
    links["base_link"].append(_cylinder(radius, high - low, (low + high) / 2))
    joints = (
        _joint("root_x_axis_joint", "prismatic", ("root", "root_arm_1_link_1"), (1, 0, 0), (-FAR, FAR)),
        _joint("root_y_axis_joint", "prismatic", ("root_arm_1_link_1", "root_arm_1_link_2"), (0, 1, 0), (-FAR, FAR)),
        _joint("root_z_rotation_joint", "continuous", ("root_arm_1_link_2", "base_link"), (0, 0, 1)),
        _joint("crouch_joint", "prismatic", ("base_link", "hips"), DOWN, (0.0, DEEPEST), HIP_HEIGHT),
        _joint("bend_joint", "revolute", ("hips", "waist"), (0, 1, 0), (0.0, BOW)),
        _joint("pelvis_joint", "fixed", ("waist", "pelvis"), height=HIP),
    )
    pelvis = next((link for link in robot.findall("link") if link.get("name") == "pelvis"), None)
    if pelvis is None:
        raise UnknownDescriptionError("ManiSkill's G1 has no pelvis; hazard_ms knows the one of ManiSkill 3.0.1")
    pelvis.append(_cylinder(*PELVIS, 0.0))
    for number, part in enumerate((*links.values(), *joints)):
        robot.insert(number, part)


def _link(name: str) -> Element:
    """A link of SMALL_MASS."""
    link = Element("link", name=name)
    inertial = SubElement(link, "inertial")
    SubElement(inertial, "mass", value=str(SMALL_MASS))
    SubElement(inertial, "inertia", ixx="0.001", ixy="0", ixz="0", iyy="0.001", iyz="0", izz="0.001")
    return link


def _joint(
    name: str,
    kind: str,
    links: tuple[str, str],
    axis: tuple[float, float, float] = (0, 0, 1),
    limits: tuple[float, float] | None = None,
    height: float = 0.0,
) -> Element:
    """A joint between two `links`, `height` [m] above the first; `limits` [m] or [rad]."""
    joint = Element("joint", name=name, type=kind)
    SubElement(joint, "origin", xyz=f"0 0 {height}", rpy="0 0 0")
    SubElement(joint, "parent", link=links[0])
    SubElement(joint, "child", link=links[1])
    SubElement(joint, "axis", xyz=" ".join(str(v) for v in axis))
    if limits is not None:
        SubElement(joint, "limit", lower=str(limits[0]), upper=str(limits[1]), effort="1000", velocity="100")
    return joint


def _cylinder(radius: float, length: float, height: float) -> Element:
    """An upright collision cylinder with its middle at `height` [m]."""
    collision = Element("collision")
    SubElement(collision, "origin", xyz=f"0 0 {height}", rpy="0 0 0")
    SubElement(SubElement(collision, "geometry"), "cylinder", radius=str(radius), length=str(length))
    return collision
