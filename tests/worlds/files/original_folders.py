"""Small scene folders of the original benchmark's format, written by hand, for tests."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np

from hazard_ms.spec import Body, Fixture, SceneSpec

CABINET = "cabinet_36_two_door_wood_beech_honey_composite"  # 0.91426 x 0.92142 (up) x 0.64735 m
SWAP = np.array([[1, 0, 0], [0, 0, 1], [0, 1, 0]])  # the original's axes in ours


def of_id(spec: SceneSpec, i: int) -> Body | Fixture:
    """The thing with the original's id `i`."""
    return next(t for t in spec.things if t.name.endswith(f"_{i}"))


def matrix(q: tuple[float, float, float, float]) -> np.ndarray:
    """The rotation matrix of a quaternion w, x, y, z, [3, 3]."""
    w, x, y, z = q
    cross = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    return np.eye(3) + 2 * w * cross + 2 * cross @ cross


def xyz(x: float, y: float, z: float) -> dict[str, float]:
    return {"x": x, "y": y, "z": z}


def add(i: int, name: str, category: str, at: tuple[float, float, float], **more: Any) -> dict[str, Any]:
    """The command that adds an object."""
    return {
        "$type": "add_object",
        "id": i,
        "name": name,
        "category": category,
        "position": xyz(*at),
        "scale_factor": 1.0,
        **more,
    }


def fixed(i: int, kinematic: bool = True) -> dict[str, Any]:
    return {"$type": "set_kinematic_state", "id": i, "is_kinematic": kinematic, "use_gravity": True}


def kitchen() -> list[dict[str, Any]]:
    """A cabinet, turned by 90 degrees, with a pot on it and a jar in it; a tilted plate on the floor; a bottle."""
    box = {"half_extents": xyz(0.44, 0.18, 0.28), "rotation": xyz(0, 0, 0)}
    return [
        {"$type": "set_screen_size", "width": 1280, "height": 720},
        {"$type": "add_scene", "name": "mm_kitchen_2a", "url": "https://example.org"},
        add(1, CABINET, "cabinet", (1.0, 0.0, 2.0)),
        fixed(1),
        {
            "$type": "add_box_container",
            "id": 1,
            "container_id": 9,
            "position": xyz(0, 0.281, 0),
            "tag": "enclosed",
            **box,
        },
        add(2, "pot", "pot", (1.2, 0.93, 2.1)),
        fixed(2, False),
        {"$type": "set_mass", "id": 2, "mass": 2.5},
        {"$type": "set_physic_material", "id": 2, "dynamic_friction": 0.4, "static_friction": 0.5, "bounciness": 0.6},
        add(3, "b04_honey_jar_max_2014", "jar", (0.9, 0.101, 1.95)),
        {"$type": "parent_object_to_object", "id": 2, "parent_id": 1},
        {"$type": "parent_object_to_object", "id": 3, "parent_id": 1},
        {"$type": "rotate_object_by", "id": 1, "angle": 90, "axis": "yaw", "is_world": True, "use_centroid": False},
        {"$type": "unparent_object", "id": 2},
        {"$type": "unparent_object", "id": 3},
        add(4, "plate05", "plate", (-1.0, 0.2, -1.0), rotation=xyz(20, 30, 40)),
        fixed(4),
        add(5, "b04_whiskeybottle", "bottle", (0.0, 0.0, 0.0), rotation=xyz(0, 30, 0)),
        {"$type": "step_physics", "frames": 50},
    ]


FIRE_INFO: dict[str, Any] = {
    "task": "fire",
    "containers": [],
    "agent": [0.5, 0.0, -2.25],
    "targets": ["bottle"],
    "other": {"fire": [[1.0, 0.0, -2.0], [-0.25, 0.0, 1.0]]},
}
FLOOD: dict[str, Any] = {
    "source": [[2.37, 1.5, 0]],
    "direction": [[45, 0, 0]],
    "speed": [5],
    "flood_source_from": "x_max",
}


def street() -> list[dict[str, Any]]:
    """Two carts, two bags and a can in the region whose middle is (55, 0)."""
    return [
        {"$type": "add_scene", "name": "suburb_scene_2023", "url": "https://example.org"},
        add(1, "b03_shoppingcart_2013", "shopping cart", (58.0, 0.02, 1.0), rotation=xyz(0, 320, 0)),
        fixed(1),
        add(2, "b04_shoppping_cart", "shopping cart", (52.0, 0.02, -3.0)),
        fixed(2),
        add(3, "purse", "bag, handbag, pocketbook, purse", (50.0, 0.32, 4.0)),
        {"$type": "scale_object", "id": 3, "scale_factor": xyz(2.0, 2.0, 2.0)},
        add(4, "red_bag", "bag, handbag, pocketbook, purse", (61.5, 0.32, -7.75)),
        add(5, "102_pepsi_can_12_fl_oz_vray", "soda can", (55.0, 0.32, 5.0)),
        {"$type": "terminate"},
    ]


WIND_INFO: dict[str, Any] = {
    "task": "wind",
    "containers": [1, 2],
    "agent": [55.25, 0.02, 2.0],
    "targets": [3, 4, 5],
    "other": {"wind_resistence": {"3": 0, "4": 1, "5": 2.5}, "wind": [1.5, 0.0, -4.25]},
}


def folder(where: Path, commands: Any, info: Any, flood: Any = None) -> Path:
    """Write a scene folder.

    Commands stand on two lines, as the original writes some of its logs; texts are written as they are.
    """
    where.mkdir(parents=True)
    half = len(commands) // 2 if isinstance(commands, list) else 0
    log = commands if isinstance(commands, str) else f"{json.dumps(commands[:half])}\n{json.dumps(commands[half:])}\n"
    (where / "log.txt").write_text(log)
    (where / "info.json").write_text(info if isinstance(info, str) else json.dumps(info))
    if flood is not None:
        (where / "flood.json").write_text(flood if isinstance(flood, str) else json.dumps(flood))
    return where
