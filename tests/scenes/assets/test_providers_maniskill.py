"""ManiSkill's own builders build what the providers find."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from hazard_ms.scenes.assets.providers import provider

SCENE = """
import json, sys, sapien, torch
from types import SimpleNamespace
from mani_skill.envs.scene import ManiSkillScene
from mani_skill.envs.utils.system.backend import parse_sim_and_render_backend
from hazard_ms.scenes.assets.providers import provider
from hazard_ms.machine.render_backend import DEVICES, backend
def scene(draw):
    systems = [sapien.physx.PhysxCpuSystem()]
    if draw:
        systems.append(sapien.render.RenderSystem(sapien.Device(DEVICES[backend()])))
    info = parse_sim_and_render_backend("physx_cpu", backend() if draw else "none")
    return ManiSkillScene([sapien.Scene(systems)], device=torch.device("cpu"), backend=info)
"""
MODELS = """
made = scene(draw=False)
builder = provider("ycb").build(made, "025_mug")
builder.initial_pose = sapien.Pose([0, 0, 1])
mug = builder.build("mug")
cabinet = provider("partnet-mobility").build(made, "1000")
cabinet.initial_pose = sapien.Pose([0, 0, 2])
cabinet = cabinet.build("cabinet")
try:
    provider("replicacad").build(SimpleNamespace(scene=made), "apt_3")
except ValueError as error:
    joints = [j.name for j in cabinet.active_joints]
    print("OUT" + json.dumps({"mug": mug.pose.p.tolist(), "joints": joints, "error": str(error)}))
"""
SCENES = """
out = {}
for name, which in (("replicacad", "apt_3"), ("architecthor", "ArchitecTHOR-Val-02")):
    env = SimpleNamespace(scene=scene(draw=True), num_envs=1, robot_uids="fetch")
    env._custom_human_render_camera_configs = {}
    built = provider(name).build(env, which)
    movable = {k: v.initial_pose.p.tolist() for k, v in built.movable_objects.items()}
    out[name] = {"all": sorted(built.scene_objects), "movable": movable}
print("OUT" + json.dumps(out))
"""


def with_maniskill(code: str, data: Path) -> dict[str, object]:
    """What `code` prints in a process of its own: ManiSkill reads its folder when it is imported."""
    env = {**os.environ, "MS_ASSET_DIR": str(data.parent)}
    words = [sys.executable, "-c", SCENE + code]
    done = subprocess.run(words, capture_output=True, text=True, env=env, timeout=200, cwd=Path(__file__).parents[3])
    assert done.returncode == 0, done.stderr[-3000:]
    return json.loads(done.stdout.partition("OUT")[2])


def test_maniskill_builds_models(data: Path) -> None:
    out = with_maniskill(MODELS, data)
    assert out["mug"] == [[0.0, 0.0, 1.0]] and out["joints"] == ["j1"]
    assert "need a renderer" in str(out["error"])


@pytest.mark.render
@pytest.mark.long
def test_maniskill_builds_scenes(data: Path) -> None:
    """An environment's four attributes are all that these builders look at."""
    out = with_maniskill(SCENES, data)
    for name, moves, height in (("replicacad", "cup-0", 2.0), ("architecthor", "Apple_1_0", 2.005)):
        assert len(out[name]["all"]) == 2  # type: ignore[index]
        ((which, where),) = out[name]["movable"].items()  # type: ignore[index]
        assert which.endswith(moves)
        np.testing.assert_allclose(np.ravel(where), [1.0, -3.0, height], atol=1e-5)  # y up to z up


def test_a_folder_that_maniskill_does_not_read_is_refused(data: Path) -> None:
    """Here ManiSkill was imported before its folder was set."""
    import mani_skill

    assert mani_skill.ASSET_DIR != data
    with pytest.raises(ValueError, match="set MS_ASSET_DIR before"):
        provider("ycb").build(None, "025_mug")
