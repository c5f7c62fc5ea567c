"""The shipped models in real physics: a convex shape for each hull, and all come to rest where they are put."""

from __future__ import annotations

import subprocess
import sys
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np

from hazard_ms.scenes.assets.index import asset_path
from hazard_ms.scenes.assets.rows import Asset
from tests.worlds.files.shipped_models import hulls_of, mesh_of, models

CHILD = """
import sys
import sapien
from sapien.physx import PhysxCollisionShapeConvexMesh as Shape
material = sapien.physx.PhysxMaterial(0.5, 0.5, 0.0)
for file in sys.argv[1:]:
    print(file, flush=True)
    print(len(Shape.load_multiple(file, [1, 1, 1], material)), flush=True)
"""


@cache
def shapes_in_sapien() -> dict[str, int]:
    """Number of convex shapes that SAPIEN makes of each file of hulls.

    Asked in a child, for a bad hull crashes SAPIEN.
    """
    files = [str(asset_path(a.hulls)) for a in models() if a.hulls]
    child = subprocess.run([sys.executable, "-c", CHILD, *files], capture_output=True, text=True, check=False)
    lines = child.stdout.split("\n")
    assert child.returncode == 0, f"SAPIEN crashes when it loads {[line for line in lines if line.startswith('/')][-1]}"
    return {Path(file).name: int(number) for file, number in zip(lines[:-1:2], lines[1::2], strict=True)}


def test_sapien_makes_one_convex_shape_of_each_hull() -> None:
    made = shapes_in_sapien()
    for a in models():
        if a.hulls:
            assert made[Path(a.hulls).name] == len(hulls_of(a.hulls)), a.id


def test_all_objects_come_to_rest_where_they_are_put() -> None:
    """Dropped from 1 cm: after 3 s still, upright, at most 5 mm in the floor."""
    assert shapes_in_sapien()
    dropped = [a for a in models() if a.kind == "object"]
    poses, speeds = drop(dropped, height=0.01, seconds=3.0)
    bad = []
    for a, pose, speed in zip(dropped, poses, speeds, strict=True):
        matrix = pose.to_transformation_matrix()
        corners = hull_points(a) @ matrix[:3, :3].T + matrix[:3, 3]
        tilt = np.degrees(np.arccos(np.clip(matrix[2, 2], -1, 1)))
        lowest = corners[:, 2].min()
        faults = {"moves": speed > 0.005, "sunk": lowest < -0.005, "afloat": lowest > 0.005, "tilted": tilt > 10}
        if any(faults.values()):
            bad.append((a.id, [k for k, wrong in faults.items() if wrong], round(speed, 4), round(float(tilt), 1)))
    assert not bad


def hull_points(a: Asset) -> np.ndarray:
    """Corners of the collision shapes [m], [N, 3], asset frame."""
    if a.hulls:
        return np.asarray(mesh_of(a.hulls).vertices)
    signs = np.array(np.meshgrid([-1, 1], [-1, 1], [-1, 1])).T.reshape(-1, 3)
    return np.concatenate([np.array(b[:3]) + signs * b[3:] for b in a.boxes])


def environments_physics() -> None:
    """Set the contacts and the solver of the next scene as environments do; SAPIEN's own are others."""
    import sapien
    from mani_skill.utils.structs.types import SimConfig

    config = SimConfig()
    physics = config.scene_config
    sapien.physx.set_shape_config(contact_offset=physics.contact_offset, rest_offset=physics.rest_offset)
    sapien.physx.set_body_config(
        solver_position_iterations=physics.solver_position_iterations,
        solver_velocity_iterations=physics.solver_velocity_iterations,
        sleep_threshold=physics.sleep_threshold,
    )
    sapien.physx.set_scene_config(gravity=physics.gravity, bounce_threshold=physics.bounce_threshold)
    sapien.physx.set_default_material(**config.default_materials_config.dict())


def drop(things: list[Asset], height: float, seconds: float) -> tuple[list[Any], list[float]]:
    """Final poses and speeds [m/s] of objects with the masses of the index, dropped side by side by our own builder."""
    import sapien

    from hazard_ms.simulation.building import add_collision

    environments_physics()
    scene = sapien.Scene([sapien.physx.PhysxCpuSystem()])
    scene.set_timestep(1 / 120)
    scene.add_ground(0.0, render=False)
    entities = []
    for k, a in enumerate(things):
        builder = scene.create_actor_builder()
        add_collision(builder, a, (1.0, 1.0, 1.0))
        builder.initial_pose = sapien.Pose([k % 10, k // 10, height])
        entity = builder.build(name=a.id)
        x, y, z = a.extent
        body = entity.find_component_by_type(sapien.physx.PhysxRigidDynamicComponent)
        body.set_mass(a.mass)
        body.set_cmass_local_pose(sapien.Pose([0.0, 0.0, z / 2]))
        body.set_inertia([a.mass / 12 * (y * y + z * z), a.mass / 12 * (x * x + z * z), a.mass / 12 * (x * x + y * y)])
        entities.append(entity)
    for _ in range(round(seconds * 120)):
        scene.step()
    bodies = [e.find_component_by_type(sapien.physx.PhysxRigidDynamicComponent) for e in entities]
    return [e.get_pose() for e in entities], [float(np.linalg.norm(b.linear_velocity)) for b in bodies]
