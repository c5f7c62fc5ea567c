"""All pictures of one scene: an episode in which nobody acts, stopped at frames spread over its length.

They depend on task, split, scene and seed alone. Hazards go on while nobody draws; at each stop the camera visits
several places. The folder of a scene appears whole or not at all.
"""

from __future__ import annotations

import io
import zlib
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any, NamedTuple

import cv2
import gymnasium as gym
import numpy as np
import sapien
import torch
from numpy.typing import NDArray

from hazard_ms.evaluation.choices import EFFECTS
from hazard_ms.perception import coco
from hazard_ms.perception.eye import Eye, Sensed, Shot
from hazard_ms.perception.layout import (
    DEPTH,
    ENDINGS,
    FORMAT,
    HAZARD,
    IDS,
    PICTURES,
    RGB,
    THERMAL,
    THERMAL_ENDING,
    folder_of,
    room_of,
    text_of,
)
from hazard_ms.perception.options import VARIED, CaptureOptions
from hazard_ms.perception.states import Watch, attributes, stirred
from hazard_ms.perception.viewpoints import viewpoints
from hazard_ms.sensing.camera import NOTHING, STRUCTURE, points_of_depth
from hazard_ms.simulation.drawing.lighting import DRAWN
from hazard_ms.tasks import task_of
from hazard_ms.tasks.spare import file_of, number_of

POSES = 8  # pictures of a stop [ours]
WATCHED_EVERY = 10  # frames, after which what is wet is noted: the flood of the original rises as often
QUALITY = 92  # of the JPEG files, of 100 [ours]
SHARES = (0.8, 0.1, 0.1)  # of pictures with effects full, fast and off, where they are varied [ours]
EXPOSURE = 0.5  # stops by which a picture is lighter or darker, at most [ours]
GAMMA = 2.2  # between light and the numbers of a picture, as in all our pictures
OF_TARGETS, OF_HAZARDS = 0.9, 0.6  # shares of pictures that must show a target, or a hazard at work [ours]
WALL, NEAREST = 0.98, 250  # share of walls and sky in a picture at most; distance of what is seen at least [mm] [ours]
MOST_TRIES = 6  # pictures that are taken for one that is kept [ours]
SAMPLES = 64  # of the hazards' levels along each edge of a picture [ours]
IMAGES_EACH = 100_000  # ids of images that each scene of a split has at its disposal


class Taken(NamedTuple):
    """One picture that is kept: from where, with which effects, what it shows, and whether a hazard is seen in it."""

    pose: sapien.Pose
    mode: str
    shot: Shot
    hazard: bool


def capture_scene(options: CaptureOptions, scene: str, folder: Path, alive: Callable[[], None]) -> None:
    """Take all pictures of `scene` and write them into `folder`, which is empty; call `alive` at every stop.

    Raises ValueError for scenes neither of the split nor spare, where nothing draws, and where the simulation breaks.
    """
    for name in (*ENDINGS, *([THERMAL] if options.thermal else [])):
        (folder / name).mkdir()
    key = zlib.crc32(f"{options.env.env_id} {options.env.split} {scene}".encode())
    seed = int(np.random.default_rng([key, options.seed]).integers(2**31))
    task = task_of(options.env.env_id, options.env.physics, options.env.hazards or None, options.env.severity)
    number = number_of(scene, task.scenes(options.env.split))
    with file_of(scene, task.scenes(options.env.split)) as played:
        episode = options.episode(played, seed)
        env: Any = gym.make(episode.env_id, obs_mode="none", **episode.settings).unwrapped
    try:
        env.reset(seed=seed, options=episode.reset_options)
        first = number * IMAGES_EACH + 1
        images, rows = [], []
        for image, found in _pictures(env, options, key, folder, first, alive):
            images.append({**image, "scene": scene, "room": room_of(scene), "split": options.env.split, "seed": seed})
            rows += found
        things = env.specs[0].things
    finally:
        env.close()
    told = {
        "format": FORMAT,
        "recipe": options.recipe,
        "scene": scene,
        "things": [{"name": thing.name, "category": thing.category, "asset": thing.asset} for thing in things],
        "images": images,
        "annotations": rows,
    }
    (folder / PICTURES).write_text(text_of(told), encoding="utf-8")


def _pictures(
    env: Any, options: CaptureOptions, key: int, folder: Path, first: int, alive: Callable[[], None]
) -> Iterator[tuple[dict[str, Any], list[dict[str, Any]]]]:
    """Take the pictures of a scene, stop by stop: their rows of `images`, from id `first` on, and of `annotations`."""
    eye, watch = Eye(env, options.size, options.angle), Watch(env)
    if options.degraded:
        env.observer.display.clear_air()
    stops = -(-options.per_scene // POSES)
    for stop in range(stops):
        rng = np.random.default_rng([key, options.seed, stop])
        _play(env, watch, int((stop + rng.random()) * options.frames / stops))
        env.lights.mode = str(rng.choice(DRAWN)) if options.lights == VARIED else options.lights
        lighting = env.lights.chosen(env.world.chance.seed.cpu())[0]
        eye.show()
        states, positions = attributes(env, watch), env.world.position[0].double().cpu().numpy()
        for k in range(stop * POSES, min((stop + 1) * POSES, options.per_scene)):
            taken = _take(env, eye, options, rng, states)
            rgb = taken.shot.rgb
            if options.shader != "default":
                rgb = eye.ray_traced(taken.pose, options.shader, options.spp)
            exposure = round(float(rng.uniform(-EXPOSURE, EXPOSURE)), 3)
            sensed = Sensed.of(env, taken.shot, rgb, str(k), options.thermal, options.degraded)
            image = _write(env, folder, k, taken.shot, sensed, exposure) | {
                "id": first + k,
                "frame": int(env.world.frame[0]),
                "lighting": lighting,
                "effects": taken.mode,
                "shader": options.shader,
                "exposure_ev": exposure,
                "hazard_visible": taken.hazard,
                **sensed.told,
            }
            rows = coco.annotations_of(taken.shot, first + k, env.specs[0].things, states, positions)
            if options.amodal:
                told = {row["instance"]: row for row in rows if row["attributes"]["target"]}
                for thing, mask in eye.alone(taken.pose, list(told)).items():
                    coco.add_amodal(told[thing], mask)
            yield image, rows
        alive()


def _play(env: Any, watch: Watch, frame: int) -> None:
    """Let the hazards go on to `frame` while the robot stands still. Raises ValueError where the simulation breaks."""
    still = torch.zeros(env.action_space.shape)
    for now in range(int(env.world.frame[0]), frame):
        env.advance(still)
        if now % WATCHED_EVERY == 0:
            watch.look()
    if bool(env.episode.sim_error[0]):
        raise ValueError(f"the simulation of {env.specs[0].name} broke before frame {frame}")


def _take(env: Any, eye: Eye, options: CaptureOptions, rng: np.random.Generator, states: list[dict[str, Any]]) -> Taken:
    """One picture of the frame as it is shown: of MOST_TRIES the first that shows what it should, else the best."""
    exists = env.world.exists[0].cpu().numpy()
    target = np.array([row["target"] for row in states]) & exists
    active = np.array([stirred(row) for row in states]) & exists
    wants_target, wants_hazard = rng.random() < OF_TARGETS, rng.random() < OF_HAZARDS and active.any()
    wanted = active if wants_hazard else target if wants_target else np.zeros_like(target)
    mode = str(rng.choice(EFFECTS, p=SHARES)) if options.looks == VARIED else options.looks
    mode = mode if options.shader == "default" else "full"
    poses, best, most = viewpoints(env, rng, wanted, options.angle), None, -1
    for _ in range(MOST_TRIES):
        pose = next(poses)
        shot = eye.shot(pose, mode)
        seen = np.bincount(shot.labels[shot.labels >= 0], minlength=len(states)) >= coco.LEAST_PIXELS
        hazard = bool((seen & active).any()) or under_water(env, shot)
        merit = 4 * _sound(shot) + 2 * (hazard or not wants_hazard) + bool((seen & target).any() or not wants_target)
        if merit > most:
            best, most = Taken(pose, mode, shot, hazard), merit
        if merit == 7:
            break
    assert best is not None
    return best


def _sound(shot: Shot) -> bool:
    """Whether a picture shows more than walls and sky, from not too near."""
    hits = shot.depth[shot.depth > 0]
    walls = np.isin(shot.labels, (STRUCTURE, NOTHING)).mean()
    return bool(len(hits) and hits.min() >= NEAREST and walls <= WALL)


def under_water(env: Any, shot: Shot) -> bool:
    """Whether a picture shows a point below the water."""
    if "water" not in env.world.fields:
        return False
    points, there = _points(env, shot)
    return bool((there & (env.world.fields["water"](points) > points[..., 2])).any())


def _points(env: Any, shot: Shot) -> tuple[torch.Tensor, torch.Tensor]:
    """SAMPLES x SAMPLES points [m] that a picture shows, row by row, [1, P, 3], and which lie on a surface, [1, P]."""
    given = (shot.depth.astype(np.float32) * 1e-3, shot.intrinsic, shot.cam2world)
    depth, intrinsic, matrix = (torch.from_numpy(np.asarray(a, np.float32))[None].to(env.device) for a in given)
    points, there = points_of_depth(depth, intrinsic, matrix, (SAMPLES, SAMPLES))
    return points.flatten(1, 2), there.flatten(1)


def exposed(picture: NDArray[np.uint8], stops: float) -> NDArray[np.uint8]:
    """A picture, [H, W, 3], of as many times the light as 2 to the power of `stops`."""
    table = np.arange(256) * 2.0 ** (stops / GAMMA) + 0.5
    lighter: NDArray[np.uint8] = np.clip(table, 0, 255).astype(np.uint8)[picture]
    return lighter


def _write(env: Any, folder: Path, number: int, shot: Shot, sensed: Sensed, exposure: float) -> dict[str, Any]:
    """Write the files of one picture. Returns their names, below the dataset, with the camera's matrices."""
    names = {kind: f"{kind}/{number:04d}{ending}" for kind, ending in ENDINGS.items()}
    rgb = exposed(sensed.rgb, exposure)
    settings = [cv2.IMWRITE_JPEG_QUALITY, QUALITY, cv2.IMWRITE_JPEG_OPTIMIZE, 1]
    points, there = _points(env, shot)
    levels = torch.where(there[:, None], env.episode.levels(points), torch.nan)[0].unflatten(-1, (SAMPLES, SAMPLES))
    arrays = {
        h.name: level.cpu().numpy().astype(np.float32) for h, level in zip(env.episode.hazards, levels, strict=True)
    }
    contents = {
        RGB: cv2.imencode(ENDINGS[RGB], rgb[..., ::-1], settings)[1].tobytes(),
        DEPTH: cv2.imencode(ENDINGS[DEPTH], sensed.depth)[1].tobytes(),
        IDS: cv2.imencode(ENDINGS[IDS], coco.ids_of(shot.labels))[1].tobytes(),
        HAZARD: _packed(arrays),
    }
    if sensed.thermal is not None:
        names[THERMAL], contents[THERMAL] = (
            f"{THERMAL}/{number:04d}{THERMAL_ENDING}",
            _packed({THERMAL: sensed.thermal}),
        )
    for kind, content in contents.items():
        (folder / names[kind]).write_bytes(content)
    place = f"{env.choice.split}/{folder_of(env.specs[0].name)}"
    row = {
        "file_name": f"{place}/{names[RGB]}",
        "width": rgb.shape[1],
        "height": rgb.shape[0],
        "depth_file": f"{place}/{names[DEPTH]}",
        "ids_file": f"{place}/{names[IDS]}",
        "hazard_file": f"{place}/{names[HAZARD]}",
        "camera": {"intrinsic": shot.intrinsic.tolist(), "cam2world": shot.cam2world.tolist()},
    }
    return row | ({"thermal_file": f"{place}/{names[THERMAL]}"} if THERMAL in names else {})


def _packed(arrays: dict[str, Any]) -> bytes:
    """The content of a .npz file that holds `arrays`, [...], in their units."""
    made = io.BytesIO()
    np.savez_compressed(made, **arrays)
    return made.getvalue()
