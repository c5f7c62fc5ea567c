"""Collision shapes: convex hulls that stand on a flat foot, or boxes for what must stay hollow."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import coacd
import numpy as np
import trimesh

MAX_VERTICES = 64  # of a convex hull: PhysX on the GPU takes no more
MAX_HULLS = 8
MIN_THICKNESS = 0.006  # [m] thinner shapes slip through floors at 120 Hz
FOOT = 0.03  # of the height: what lies lower is pressed flat, so that things stand and do not roll
UNEVEN = 0.005  # hulls are drawn in by up to this share, by chance
FAST = {  # about ten times faster than CoACD's defaults, a quarter of the hulls
    "threshold": 0.1,
    "max_convex_hull": MAX_HULLS,
    "preprocess_resolution": 30,
    "resolution": 1000,
    "mcts_iterations": 60,
    "mcts_nodes": 12,
    "mcts_max_depth": 2,
    "max_ch_vertex": MAX_VERTICES,
    "decimate": True,
}


def decompose(mesh: trimesh.Trimesh, how: dict[str, Any]) -> list[trimesh.Trimesh]:
    """Convex hulls that cover `mesh` and lie inside its bounds.

    `how` is one of {"coacd": pieces}, {"slabs": [axis, [fractions of the extent at which to cut]]}, {"sectors": count}: a bottom and
    wedges around z, for open vessels; or {}: a single hull. "foot" is the share of the height that is pressed flat.
    """
    low, high = mesh.bounds
    if "coacd" in how:
        coacd.set_log_level("error")
        found = coacd.run_coacd(coacd.Mesh(mesh.vertices, mesh.faces), **{**FAST, "max_convex_hull": how["coacd"]})
        clouds = [np.asarray(vertices) for vertices, _ in found]
    elif "slabs" in how:
        axis = "xyz".index(how["slabs"][0])
        clouds = _slabs(mesh, axis, [low[axis] + f * (high[axis] - low[axis]) for f in how["slabs"][1]])
    elif "sectors" in how:
        clouds = _sectors(mesh, how["sectors"], low[2] + 0.12 * (high[2] - low[2]))
    else:
        clouds = [np.asarray(mesh.vertices)]
    high = np.maximum(high, low + [0.0, 0.0, MIN_THICKNESS])
    return [_hull(np.clip(cloud, low, high), low, high, how.get("foot", FOOT)) for cloud in clouds]


def _slabs(mesh: trimesh.Trimesh, axis: int, at: list[float]) -> list[np.ndarray]:
    """Vertices of the slices of `mesh` between the planes `at` [m]."""
    edges = [-np.inf, *at, np.inf]
    clouds = [_between(mesh, np.eye(3)[axis], a, b) for a, b in zip(edges[:-1], edges[1:], strict=True)]
    return [c for c in clouds if len(c) > 3]


def _sectors(mesh: trimesh.Trimesh, count: int, bottom: float) -> list[np.ndarray]:
    """Vertices of the bottom, and of the wall above it in `count` wedges around z."""
    wall = mesh.slice_plane([0, 0, bottom], [0, 0, 1])
    clouds = [_between(mesh, np.array([0.0, 0.0, 1.0]), -np.inf, bottom)]
    for angle in np.arange(count) * 2 * np.pi / count:
        wedge = wall
        for a, sign in ((angle, 1), (angle + 2 * np.pi / count, -1)):
            wedge = wedge.slice_plane([0, 0, 0], [-sign * np.sin(a), sign * np.cos(a), 0])
        clouds.append(np.asarray(wedge.vertices))
    return [c for c in clouds if len(c) > 3]


def _between(mesh: trimesh.Trimesh, normal: np.ndarray, low: float, high: float) -> np.ndarray:
    part = mesh
    if np.isfinite(low):
        part = part.slice_plane(normal * low, normal)
    if np.isfinite(high) and len(part.faces):
        part = part.slice_plane(normal * high, -normal)
    return np.asarray(part.vertices)


def _hull(points: np.ndarray, low: np.ndarray, high: np.ndarray, press: float) -> trimesh.Trimesh:
    """Convex hull of at most MAX_VERTICES of `points`; its lowest part becomes a flat foot at the height low[2]."""
    near = points[:, 2] < low[2] + max(0.001, press * (high[2] - low[2]))
    foot = points[near] * [1, 1, 0] + [0, 0, low[2]]
    body = points[~near]
    if len(body) == 0 or np.ptp(points[:, 2]) < MIN_THICKNESS:  # too thin: a slab as high as is needed
        body = points * [1, 1, 0] + [0, 0, min(low[2], points[:, 2].min()) + MIN_THICKNESS]
    chosen = body[_extreme(body, _sphere(40))]
    inward = np.random.default_rng(1).uniform(0.0, UNEVEN, (len(chosen), 1))  # points in one plane can crash PhysX's cooking
    chosen = chosen + inward * (chosen.mean(axis=0) - chosen)
    if len(foot):
        angle = np.linspace(0, 2 * np.pi, 16, endpoint=False)
        chosen = np.vstack([chosen, foot[_extreme(foot, np.stack([np.cos(angle), np.sin(angle), 0 * angle], 1))]])
    return trimesh.Trimesh(np.unique(chosen.round(5), axis=0), [], process=False).convex_hull


def _extreme(points: np.ndarray, directions: np.ndarray) -> np.ndarray:
    """Indices of the points that reach farthest in each direction."""
    return np.unique((points @ directions.T).argmax(axis=0))


def _sphere(count: int) -> np.ndarray:
    """Directions spread over the sphere (Fibonacci lattice), and the six axes."""
    k = np.arange(count) + 0.5
    z, angle = 1 - 2 * k / count, np.pi * (1 + 5**0.5) * k
    r = np.sqrt(1 - z**2)
    return np.vstack([np.stack([r * np.cos(angle), r * np.sin(angle), z], 1), np.eye(3), -np.eye(3)])


def write_hulls(hulls: list[trimesh.Trimesh], path: Path) -> None:
    """One PLY file whose connected pieces are the hulls: SAPIEN makes a convex shape of each."""
    trimesh.util.concatenate(hulls).export(path, file_type="ply", vertex_normal=False)


def boxes(shape: dict[str, Any], extent: np.ndarray) -> list[list[float]]:
    """Boxes [cx, cy, cz, hx, hy, hz] of a piece of furniture of the given `extent` [m]; `shape` names one of BOXES."""
    kind = shape["shape"]
    if kind not in BOXES:
        raise ValueError(f"no box shape is called {kind!r}; there are {', '.join(BOXES)}")
    options = {k: v for k, v in shape.items() if k != "shape"}
    return [[round(float(v), 4) for v in box] for box in BOXES[kind](np.asarray(extent), **options)]


def _span(low: Any, high: Any) -> list[float]:
    low, high = np.asarray(low, float), np.asarray(high, float)
    return [*((low + high) / 2), *((high - low) / 2)]


def _block(e: np.ndarray, top: float | None = None) -> list[list[float]]:
    return [_span([-e[0] / 2, -e[1] / 2, 0], [e[0] / 2, e[1] / 2, e[2] if top is None else top])]


def _table(e: np.ndarray, top: float, leg: float, inset: float = 0.0, round: bool = False) -> list[list[float]]:
    """A slab `top` metres thick on four square legs; a `round` one is made of boxes that cross within its edge."""
    x, y = e[0] / 2 - inset, e[1] / 2 - inset
    corners = [(np.cos(a), np.sin(a)) for a in np.deg2rad([9.0, 27.0, 45.0, 63.0, 81.0])] if round else [(1.0, 1.0)]
    slabs = [_span([*(-e[:2] / 2 * c), e[2] - top], [*(e[:2] / 2 * c), e[2]]) for c in corners]
    corners = [(sx, sy) for sx in (-1, 1) for sy in (-1, 1)]
    legs = [[sx * (x - leg / 2), sy * (y - leg / 2), (e[2] - top) / 2, leg / 2, leg / 2, (e[2] - top) / 2] for sx, sy in corners]
    return [*slabs, *legs]


def _pedestal(e: np.ndarray, top: float, stem: float, foot: float) -> list[list[float]]:
    """A slab on one stem on a foot: round tables, lamps, stools."""
    r = foot / 2
    return [
        _span([-e[0] / 2, -e[1] / 2, e[2] - top], e * [0.5, 0.5, 1]),
        _span([-stem / 2, -stem / 2, 0.03], [stem / 2, stem / 2, e[2] - top]),
        _span([-r, -r, 0], [r, r, 0.03]),
    ]


def _chair(e: np.ndarray, seat: float, leg: float, back: float, facing: str = "-y") -> list[list[float]]:
    """Seat at the height `seat`, four legs, a back `back` metres thick on the side away from `facing`."""
    side = 1 if facing == "-y" else -1
    y0, y1 = sorted((side * (e[1] / 2 - back), side * e[1] / 2))
    legs = _table(np.array([e[0], e[1], seat]), 0.06, leg)
    return [*legs, _span([-e[0] / 2, y0, seat], [e[0] / 2, y1, e[2]])]


def _sofa(e: np.ndarray, seat: float, back: float, arm: float, facing: str = "-y") -> list[list[float]]:
    side = 1 if facing == "-y" else -1
    y0, y1 = sorted((side * (e[1] / 2 - back), side * e[1] / 2))
    arm_top = seat + 0.45 * (e[2] - seat)
    arms = [_span(sorted_pair[0], sorted_pair[1]) for sorted_pair in _arms(e, arm, arm_top)] if arm else []
    return [*_block(e, seat), _span([-e[0] / 2, y0, seat], [e[0] / 2, y1, e[2]]), *arms]


def _arms(e: np.ndarray, arm: float, top: float) -> list[tuple[list[float], list[float]]]:
    x, y = e[0] / 2, e[1] / 2
    return [([-x, -y, 0], [-x + arm, y, top]), ([x - arm, -y, 0], [x, y, top])]


def _shelf(e: np.ndarray, boards: list[float], board: float, side: float, back: float = 0.01) -> list[list[float]]:
    """Open towards -y: two sides, a back, and boards whose upper faces are at the heights `boards`."""
    x, y = e[0] / 2, e[1] / 2
    walls = [
        _span([-x, -y, 0], [-x + side, y, e[2]]),
        _span([x - side, -y, 0], [x, y, e[2]]),
        _span([-x, y - back, 0], [x, y, e[2]]),
    ]
    return walls + [_span([-x, -y, max(0.0, z - board)], [x, y, z]) for z in boards]


def _frame(e: np.ndarray, bar: float) -> list[list[float]]:
    """An upright frame, open in the middle: doors, windows."""
    x, y = e[0] / 2, e[1] / 2
    return [
        _span([-x, -y, 0], [-x + bar, y, e[2]]),
        _span([x - bar, -y, 0], [x, y, e[2]]),
        _span([-x, -y, e[2] - bar], [x, y, e[2]]),
    ]


def _bin(e: np.ndarray, wall: float, top: float | None = None) -> list[list[float]]:
    """An open box: floor and four walls up to the height `top`."""
    x, y = e[0] / 2, e[1] / 2
    e = e if top is None else np.array([e[0], e[1], top])
    return [
        _span([-x, -y, 0], [x, y, wall]),
        _span([-x, -y, 0], [-x + wall, y, e[2]]),
        _span([x - wall, -y, 0], [x, y, e[2]]),
        _span([-x, -y, 0], [x, -y + wall, e[2]]),
        _span([-x, y - wall, 0], [x, y, e[2]]),
    ]


def _ring(e: np.ndarray, wall: float, handle: float) -> list[list[float]]:
    """A round open basket: a floor and eight walls that touch the circle from inside; `handle` above them."""
    r, top = min(e[0], e[1]) / 2 * 0.9, e[2] - handle
    side = 0.7 * r
    walls = [_span([s * r - wall / 2, -side, 0], [s * r + wall / 2, side, top]) for s in (-1, 1)]
    walls += [_span([-side, s * r - wall / 2, 0], [side, s * r + wall / 2, top]) for s in (-1, 1)]
    return [_span([-side, -side, 0], [side, side, 2 * wall]), *walls]


def _cart(e: np.ndarray, floor: float, rim: float, deep: float) -> list[list[float]]:
    """A shopping cart, handle at +y: the basket from the floor's height `floor` to `rim`, `deep` along y inside, and the frame below."""
    x, front, wall = e[0] / 2, -e[1] / 2, 0.03
    inner, start = x - 0.035, front + 0.06  # the basket tapers: its walls are as thick as that needs
    end = start + deep
    return [
        _span([-inner, start, floor - 0.08], [inner, end, floor]),
        _span([-x, front, floor - 0.08], [-inner, end, rim]),
        _span([inner, front, floor - 0.08], [x, end, rim]),
        _span([-inner, front, floor - 0.08], [inner, start, rim]),
        _span([-x, end, floor - 0.08], [x, end + wall, rim]),
        _span([-x, front + 0.02, 0], [x, end, 0.16]),
        *(_span([s * x - 0.02 * (s + 1), end, 0.1], [s * x - 0.02 * (s - 1), end + 0.07, rim]) for s in (-1, 1)),
        _span([-x, e[1] / 2 - 0.05, e[2] - 0.045], [x, e[1] / 2, e[2]]),
    ]


def _spans(e: np.ndarray, of: list[list[float]]) -> list[list[float]]:
    """Boxes given by their lowest and highest corners [m], six numbers each."""
    return [_span(box[:3], box[3:]) for box in of]


BOXES = {
    "cart": _cart,
    "spans": _spans,
    "ring": _ring,
    "block": _block,
    "table": _table,
    "pedestal": _pedestal,
    "chair": _chair,
    "sofa": _sofa,
    "shelf": _shelf,
    "frame": _frame,
    "bin": _bin,
}
