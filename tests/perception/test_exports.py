"""Exported datasets, as readers that are not ours find them: masks, boxes, categories and counts of the source."""

from __future__ import annotations

import json
import re
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import supervision
import yaml
from numpy.typing import NDArray
from pycocotools import mask as tools
from pycocotools.coco import COCO

from hazard_ms.perception import layout
from hazard_ms.perception.exports.export import export
from hazard_ms.perception.exports.licences import licence_of
from tests.worlds.drawn_pictures import draw


@pytest.fixture(scope="module")
def data(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Five drawn pictures for training, three for tests."""
    folder = draw(tmp_path_factory.mktemp("exports") / "Drawn", "train", 5, 96)
    draw(folder, "test", 3, 96, seed=1)
    (folder / layout.LICENCES).write_text("id,category,licence,author,source\na,apple,CC0,x,y\nb,box,CC-BY-4.0,x,y\n")
    return folder


def source(data: Path, split: str) -> dict[str, Any]:
    found: dict[str, Any] = json.loads((data / layout.instances(split)).read_text())
    return found


def masks(rows: dict[str, Any], image: int) -> list[NDArray[np.bool_]]:
    """The masks of a picture, decoded by pycocotools."""
    chosen = [row for row in rows["annotations"] if row["image_id"] == image]
    return [tools.decode(row["segmentation"]).astype(bool) for row in chosen]


def overlap(a: NDArray[np.bool_], b: NDArray[np.bool_]) -> float:
    return float((a & b).sum() / (a | b).sum())


@pytest.mark.parametrize("split", ["train", "test"])
def test_supervision_reads_yolo_with_the_same_masks_and_categories(data: Path, tmp_path: Path, split: str) -> None:
    assert export(data, "yolo", tmp_path / "out") == 8
    rows, out = source(data, split), tmp_path / "out"
    read = supervision.DetectionDataset.from_yolo(
        str(out / "images" / split), str(out / "labels" / split), str(out / "data.yaml"), force_masks=True
    )
    assert len(read) == len(rows["images"])
    names = {row["id"]: row["name"] for row in rows["categories"]}
    assert read.classes == [names[number] for number in sorted(names)]
    for image in rows["images"]:
        found = read.annotations[str(out / "images" / split / f"{image['id']:012d}.jpg")]
        wanted = [row for row in rows["annotations"] if row["image_id"] == image["id"]]
        assert [read.classes[k] for k in found.class_id] == [names[row["category_id"]] for row in wanted]
        for seen, true in zip(found.mask, masks(rows, image["id"]), strict=True):
            assert overlap(seen, true) == 1.0


def test_yolo_has_the_documented_layout(data: Path, tmp_path: Path) -> None:
    """docs.ultralytics.com/datasets/segment: one .txt a picture, `class x1 y1 ... xn yn`, 3 corners, 0 to 1."""
    out = tmp_path / "out"
    export(data, "yolo", out)
    told = yaml.safe_load((out / "data.yaml").read_text())
    assert "path" not in told and told["train"] == "images/train" and told["val"] == told["test"] == "images/test"
    assert list(told["names"]) == list(range(len(told["names"])))
    pictures = sorted(p.relative_to(out / "images").with_suffix("") for p in (out / "images").rglob("*.jpg"))
    labels = sorted(p.relative_to(out / "labels").with_suffix("") for p in (out / "labels").rglob("*.txt"))
    assert pictures == labels and len(pictures) == 8
    for path in (out / "labels").rglob("*.txt"):
        for row in path.read_text().splitlines():
            number, *shares = row.split(" ")
            assert number.isdigit() and int(number) in told["names"]
            assert len(shares) >= 6 and len(shares) % 2 == 0 and all(0.0 < float(s) < 1.0 for s in shares)


def test_rfdetr_takes_it_for_a_dataset_to_train_on(data: Path, tmp_path: Path) -> None:
    yolo = pytest.importorskip("rfdetr.datasets.yolo")
    export(data, "yolo", tmp_path / "out")
    assert yolo.is_valid_yolo_dataset(str(tmp_path / "out"))
    assert not yolo.is_valid_yolo_dataset(str(data))


def test_pycocotools_and_torchvision_read_coco_with_the_same_masks(data: Path, tmp_path: Path) -> None:
    from torchvision.datasets import CocoDetection, wrap_dataset_for_transforms_v2

    out = tmp_path / "out"
    export(data, "coco", out)
    path = out / "annotations" / "instances_test.json"
    rows, read = source(data, "test"), COCO(str(path))
    assert {c["id"]: c["name"] for c in read.loadCats(read.getCatIds())} == {
        row["id"]: row["name"] for row in rows["categories"]
    }
    for image in rows["images"]:
        found = read.loadAnns(read.getAnnIds(image["id"]))
        wanted = [row for row in rows["annotations"] if row["image_id"] == image["id"]]
        for mine, row in zip(found, wanted, strict=True):
            for key in ("id", "category_id", "bbox", "area", "iscrowd"):
                assert mine[key] == row[key], key
            assert mine["attributes"]["status"] == row["attributes"]["status"]
            assert np.array_equal(read.annToMask(mine), tools.decode(row["segmentation"]))
    plain = CocoDetection(str(out / "test"), str(path))
    wrapped = wrap_dataset_for_transforms_v2(plain, target_keys=("boxes", "labels", "masks"))
    assert len(wrapped) == 3
    picture, target = wrapped[0]
    assert picture.size == (96, 96) and len(target["masks"]) == len(masks(rows, rows["images"][0]["id"]))


def test_an_exported_coco_folder_is_read_by_supervision(data: Path, tmp_path: Path) -> None:
    out = tmp_path / "out"
    export(data, "coco", out)
    path = out / "annotations" / "instances_train.json"
    read = supervision.DetectionDataset.from_coco(str(out / "train"), str(path), force_masks=True)
    assert len(read) == 5 and sum(len(d) for d in read.annotations.values()) == len(
        source(data, "train")["annotations"]
    )


def front_matter(out: Path) -> dict[str, Any]:
    found = re.match(r"---\n(.*?)\n---\n", (out / "README.md").read_text(), re.S)
    assert found
    read: dict[str, Any] = yaml.safe_load(found[1])
    return read


def test_the_card_has_front_matter_that_the_hub_knows(data: Path, tmp_path: Path) -> None:
    from huggingface_hub import DatasetCard

    out = tmp_path / "out"
    export(data, "hf", out)
    told = front_matter(out)
    assert told["license"] == "other" and told["license_link"] == "LICENSES.csv"
    assert (out / "LICENSES.csv").read_text() == (data / "LICENSES.csv").read_text()
    assert told["task_categories"] == ["object-detection", "image-segmentation"]
    assert told["size_categories"] == ["n<1K"] and told["pretty_name"] == "Drawn"
    (config,) = told["configs"]
    assert {row["split"]: row["path"] for row in config["data_files"]} == {
        "test": "data/test/**",
        "train": "data/train/**",
    }
    card = DatasetCard.load(out / "README.md")
    assert card.data.license == "other" and "| train | 5 |" in card.text


def test_hugging_face_s_datasets_reads_it(data: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    datasets = pytest.importorskip("datasets")
    monkeypatch.setenv("HF_HUB_OFFLINE", "1")
    out = tmp_path / "out"
    export(data, "hf", out)
    for given in (("imagefolder", {"data_dir": str(out / "data")}), (str(out), {})):
        read = datasets.load_dataset(given[0], **given[1], cache_dir=str(tmp_path / f"cache{len(given[1])}"))
        assert {name: len(part) for name, part in read.items()} == {"train": 5, "test": 3}
        for split in read:
            rows = source(data, split)
            names = {row["id"]: row["name"] for row in rows["categories"]}
            for row in read[split]:
                assert row["image"].size == (96, 96)
                wanted = [r for r in rows["annotations"] if r["image_id"] == row["image_id"]]
                assert row["objects"]["category"] == [names[r["category_id"]] for r in wanted]
                assert row["objects"]["bbox"] == [r["bbox"] for r in wanted]
                assert row["objects"]["target"] == [True] * len(wanted)
                for runs, true in zip(row["objects"]["segmentation"], masks(rows, row["image_id"]), strict=True):
                    assert np.array_equal(tools.decode(runs).astype(bool), true)


def test_lines_of_metadata_tell_what_each_picture_is(data: Path, tmp_path: Path) -> None:
    out = tmp_path / "out"
    export(data, "hf", out)
    lines = [json.loads(line) for line in (out / "data" / "train" / "metadata.jsonl").read_text().splitlines()]
    assert [line["image_id"] for line in lines] == [1, 2, 3, 4, 5]
    for line in lines:
        assert (out / "data" / "train" / line["file_name"]).is_file() and line["scene"] == "kitchen_a/00"
        assert {len(values) for values in line["objects"].values()} == {len(line["objects"]["id"])}


@pytest.mark.parametrize(
    ("table", "told"),
    [
        (None, "license: unknown"),
        ("id,licence\na,CC0\nb,CC0\n", "license: cc0-1.0"),
        ("id,licence\na,CC0\nb,CC-BY-4.0\n", "license: other\nlicense_name: see-table\nlicense_link: LICENSES.csv"),
        ("id,licence\na,Mine\n", "license: other\nlicense_name: see-table\nlicense_link: LICENSES.csv"),
    ],
)
def test_the_licence_is_that_of_the_models(tmp_path: Path, table: str | None, told: str) -> None:
    if table is not None:
        (tmp_path / layout.LICENCES).write_text(table)
    assert licence_of(tmp_path) == told
