"""Pictures of models: told apart by their first bytes, decoded once, and never by a program that they start."""

from __future__ import annotations

import io
import os
import subprocess
import sys
from pathlib import Path

import pytest
from PIL import Image

from hazard_ms.scenes.assets.intake.conversion import convert
from hazard_ms.scenes.assets.intake.reading import Beside, read_model
from hazard_ms.scenes.assets.intake.textures import LARGEST_IMAGE, TEXTURE_SIZE, Textures, format_of
from tests.worlds.files.model_files import good
from tests.worlds.hostile import models, pictures
from tests.worlds.hostile.junk import text

EPS_MODELS = {
    "beside an OBJ": {"m.obj": models.OBJ, "m.mtl": b"newmtl a\nmap_Kd tex.png\n", "tex.png": pictures.EPS},
    "as an OBJ's library": {"m.obj": models.OBJ, "m.mtl": b"newmtl a\nmap_Kd m.mtl\n" + pictures.EPS},
    "inside a GLB": {"m.glb": models.embedded(pictures.EPS)},
    "inside a GLB, as DOS has it": {"m.glb": models.embedded(pictures.FOREIGN["EPS of DOS"])},
}


def model_at(folder: Path, files: dict[str, bytes]) -> Path:
    """Write the files of a model into a folder; the path of the model."""
    for name, data in files.items():
        (folder / name).write_bytes(data)
    return folder / next(iter(files))


@pytest.fixture
def started(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """The file that appears when Ghostscript is started; PIL, as it comes, does so for an EPS."""
    programs, mark = pictures.fake_ghostscript(tmp_path)
    monkeypatch.setenv("PATH", f"{programs}{os.pathsep}{os.environ['PATH']}")
    with pytest.raises(OSError, match="."):
        Image.open(io.BytesIO(pictures.EPS)).load()
    mark.unlink()
    return mark


@pytest.mark.parametrize("case", EPS_MODELS)
def test_a_texture_starts_no_program(case: str, started: Path, tmp_path: Path) -> None:
    with pytest.raises(ValueError, match="must be a PNG, JPEG or WebP file"):
        read_model(model_at(tmp_path, EPS_MODELS[case])).dump()
    assert not started.exists()


def test_adding_a_model_starts_no_program(started: Path, tmp_path: Path) -> None:
    (tmp_path / "made").mkdir()
    with pytest.raises(ValueError, match="must be a PNG, JPEG or WebP file"):
        convert(good(model_at(tmp_path, EPS_MODELS["inside a GLB"])), tmp_path / "made", 0.3)
    assert not started.exists()


@pytest.mark.parametrize("kind", pictures.FOREIGN)
def test_other_formats_are_refused_wherever_they_are(kind: str, tmp_path: Path) -> None:
    picture = pictures.FOREIGN[kind]
    assert format_of(picture) == ""
    head = models.PLY_HEAD.replace("element vertex", "comment TextureFile t.png\nelement vertex")
    for files in (
        {"m.obj": models.OBJ, "m.mtl": b"newmtl a\nmap_Kd t.png\n", "t.png": picture},
        {"m.gltf": text(models.solid(images=[{"uri": "t.png"}])), "t.png": picture},
        {"m.glb": models.embedded(picture)},
        {"m.ply": head.format(kind="ascii", corners=0, faces=0).encode(), "t.png": picture},
    ):
        with pytest.raises(ValueError, match="a texture must be a PNG, JPEG or WebP file, got (image 0 of m|t.png)"):
            read_model(model_at(tmp_path, files))


@pytest.mark.parametrize("kind", ["PNG", "JPEG", "WEBP"])
def test_true_pictures_are_read_from_everywhere(kind: str, tmp_path: Path) -> None:
    picture = pictures.true_picture(700, kind)
    for files in (
        {"m.obj": models.OBJ, "m.mtl": b"newmtl a\nmap_Kd t.png\n", "t.png": picture},
        {"m.gltf": text(models.solid(images=[{"uri": "t.png"}])), "t.png": picture},
        {"m.glb": models.embedded(picture)},
    ):
        (part,) = read_model(model_at(tmp_path, files)).geometry.values()
        image = getattr(part.visual.material, "image", None) or part.visual.material.baseColorTexture
        assert image.size == (TEXTURE_SIZE, TEXTURE_SIZE)
        assert max(abs(a - b) for a, b in zip(image.convert("RGB").getpixel((9, 9)), (200, 10, 10), strict=True)) < 5


def test_pil_itself_opens_nothing_else_in_the_worker() -> None:
    code = (
        "import io; from PIL import Image; from hazard_ms.scenes.assets.intake.textures import forbid_other_formats\n"
        "from tests.worlds.hostile import pictures; gif = io.BytesIO(); Image.new('RGB', (9, 9)).save(gif, 'GIF')\n"
        "forbid_other_formats(); Image.open(io.BytesIO(pictures.true_picture(9))).load(); opened = []\n"
        "for data in (pictures.EPS, gif.getvalue(), pictures.FOREIGN['BMP']):\n"
        "    try: opened.append(Image.open(io.BytesIO(data)).format)\n"
        "    except OSError: pass\n"
        "print(opened, sorted(Image.OPEN))"
    )
    out = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True, cwd=Path.cwd())
    assert out.stdout.strip() == "[] ['JPEG', 'PNG', 'WEBP']"


@pytest.mark.parametrize(("width", "height"), [(8193, 1), (1, 8193), (11_500, 11_500), (60_000, 60_000)])
def test_large_pictures_are_refused_by_their_header(width: int, height: int) -> None:
    """Nothing is unpacked: what follows the header is cut off."""
    with pytest.raises(ValueError, match=f"t.png must have edges of at most {LARGEST_IMAGE} pixels, got"):
        Textures().small(pictures.png(width, height)[:60], "t.png")


def test_a_picture_as_large_as_is_allowed_is_read() -> None:
    whole = io.BytesIO()
    Image.new("RGB", (LARGEST_IMAGE, 16), (1, 2, 3)).save(whole, "PNG")
    made = Image.open(io.BytesIO(Textures().small(whole.getvalue(), "t.png")))
    assert made.size == (TEXTURE_SIZE, 1) and made.getpixel((0, 0)) == (1, 2, 3)


def test_each_picture_is_read_and_decoded_once(tmp_path: Path) -> None:
    """The same bytes under other names give what was already made; a name is looked up once."""
    textures = Textures()
    beside = Beside(tmp_path, textures, plain=0)
    (tmp_path / "a.png").write_bytes(pictures.true_picture(64))
    (tmp_path / "b.png").write_bytes(pictures.true_picture(64))
    first = beside.get("a.png")
    assert beside.get("b.png") is first
    (tmp_path / "a.png").unlink()
    assert beside.get("a.png") is first


def test_pictures_that_are_not_shown_are_not_unpacked(tmp_path: Path) -> None:
    """Bumps and glow are left out of models here, so a bomb among them does no harm."""
    tree = models.solid()
    tree["images"].append({"uri": "bomb.png"})
    tree["textures"].append({"source": 1})
    tree["materials"][0]["normalTexture"] = {"index": 1}
    files = {"m.gltf": text(tree), "bomb.png": pictures.png(60_000, 60_000)}
    assert read_model(model_at(tmp_path, files)).geometry
    tree["materials"][0]["pbrMetallicRoughness"]["metallicRoughnessTexture"] = {"index": 1}
    with pytest.raises(ValueError, match="image 1 of m.gltf must have edges"):
        read_model(model_at(tmp_path, {"m.gltf": text(tree)}))


@pytest.mark.parametrize("word", ["circle", "two parents", "chain"])
def test_nodes_must_be_trees(word: str, tmp_path: Path) -> None:
    nodes = {
        "circle": [{"mesh": 0, "children": [1]}, {"children": [0]}],
        "two parents": [{"children": [i + 1, i + 1]} for i in range(40)] + [{"mesh": 0}],
        "chain": [{"children": [i + 1]} for i in range(200)] + [{"mesh": 0}],
    }[word]
    with pytest.raises(ValueError, match="nodes of m.gltf must form trees of at most 200 levels"):
        read_model(model_at(tmp_path, {"m.gltf": text(models.solid(nodes=nodes))}))
    chain = [{"children": [i + 1]} for i in range(199)] + [{"mesh": 0}]
    assert read_model(model_at(tmp_path, {"m.gltf": text(models.solid(nodes=chain))})).geometry
