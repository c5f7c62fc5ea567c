"""Robots for machines where nothing can draw."""

from __future__ import annotations

import shutil
from pathlib import Path

import pytest

from hazard_ms.robots.without_visuals import without_visuals


def test_a_robot_without_visuals_keeps_bodies_joints_and_collisions(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("HAZARD_MS_HOME", str(tmp_path / "home"))
    (tmp_path / "arm.srdf").write_text("<robot name='arm'/>")
    (tmp_path / "arm.urdf").write_text(
        "<robot name='arm'><link name='a'><inertial><mass value='2'/></inertial>"
        "<visual><geometry><mesh filename='look.dae'/></geometry>"
        "<material name='red'><color rgba='1 0 0 1'/></material></visual>"
        "<collision><geometry><mesh filename='package://meshes/a.stl'/></geometry></collision></link>"
        "<link name='b'/><joint name='j' type='fixed'><parent link='a'/><child link='b'/></joint></robot>"
    )
    bare = without_visuals(tmp_path / "arm.urdf")
    text = bare.read_text()
    assert "<visual" not in text and "look.dae" not in text
    assert 'mass value="2"' in text and 'joint name="j"' in text and str(tmp_path / "meshes/a.stl") in text
    assert bare.with_suffix(".srdf").read_text() == "<robot name='arm'/>"


def test_a_copy_that_was_deleted_is_made_again(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """The cache folder may be emptied while a process runs."""
    monkeypatch.setenv("HAZARD_MS_HOME", str(tmp_path / "home"))
    (tmp_path / "arm.urdf").write_text("<robot name='arm'><link name='a'/></robot>")
    bare = without_visuals(tmp_path / "arm.urdf")
    shutil.rmtree(tmp_path / "home")
    assert without_visuals(tmp_path / "arm.urdf") == bare and bare.is_file()
