"""Mask R-CNN fine-tuned on labelled pictures of hazards with torchvision alone, without any code of ours.

    hazard-ms perception capture -e HazardFire-v1 --size 512 -o data
    python examples/finetune_mask_rcnn.py data/HazardFire-v1/instances_train.json --weights coco.pth -o detector.pth
    hazard-ms evaluate -e HazardFire-v1 --perception mask_rcnn:detector.pth

`coco.pth` holds weights for COCO's photographs: torchvision names the file that it loads from the net as
`MaskRCNN_ResNet50_FPN_V2_Weights.COCO_V1.url`. Without, the network learns from nothing, which takes far more pictures.
`hazard-ms perception train` does the same with checkpoints and scores.
"""

from __future__ import annotations

import argparse
import json
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any

import torch
from torch.utils.data import DataLoader
from torchvision.datasets import CocoDetection, wrap_dataset_for_transforms_v2
from torchvision.models.detection import maskrcnn_resnet50_fpn_v2
from torchvision.transforms import v2

NETWORK = "maskrcnn_resnet50_fpn_v2"
RATE, MOMENTUM, DECAY, WARM = 0.005, 0.9, 1e-4, 500  # as torchvision's own training, for 2 pictures a step
HEADS = ("roi_heads.box_predictor", "roi_heads.mask_predictor.mask_fcn_logits")  # as many outputs as classes


def training_set(path: Path) -> tuple[Any, list[str]]:
    """Pictures with boxes, labels from 1 on and masks; and the names of the labels."""
    changes = v2.Compose(
        [
            v2.ToImage(),
            v2.RandomHorizontalFlip(0.5),
            v2.ColorJitter(0.4, 0.3, 0.3),
            v2.ToDtype(torch.float32, scale=True),
        ]
    )
    read = CocoDetection(str(path.parent), str(path), transforms=changes)
    used = sorted({row["category_id"] for row in read.coco.anns.values()})
    number = {category: k for k, category in enumerate(used, start=1)}
    for row in read.coco.anns.values():
        row["category_id"] = number[row["category_id"]]
    read.ids = sorted({row["image_id"] for row in read.coco.anns.values()})  # those in which something is to be found
    names = [read.coco.cats[category]["name"] for category in used]
    return wrap_dataset_for_transforms_v2(read, target_keys=("boxes", "labels", "masks")), names


def network(classes: int, weights: Path | None, size: int) -> torch.nn.Module:
    """Mask R-CNN for so many classes, with all of `weights` but the heads."""
    made = maskrcnn_resnet50_fpn_v2(weights=None, weights_backbone=None, num_classes=1 + classes, min_size=size)
    if weights is not None:
        given = torch.load(weights, map_location="cpu", weights_only=True)
        told = made.load_state_dict({k: v for k, v in given.items() if not k.startswith(HEADS)}, strict=False)
        lack = [key for key in told.missing_keys if not key.startswith(HEADS)]
        if lack or told.unexpected_keys:
            raise SystemExit(f"{weights} must hold maskrcnn_resnet50_fpn_v2, got {list(given)[:3]} and so on")
    return made


def endless(data: Any, batch: int) -> Iterator[Any]:
    """Batches in an order drawn anew for each pass over the pictures."""
    while True:
        yield from DataLoader(data, batch, shuffle=True, collate_fn=lambda rows: tuple(zip(*rows, strict=True)))


def train(model: torch.nn.Module, data: Any, steps: int, batch: int) -> list[float]:
    """The loss of every step."""
    device = torch.device("cuda" if torch.cuda.is_available() else "cpu")
    model.to(device).train()
    optimiser = torch.optim.SGD(model.parameters(), RATE * batch / 2, MOMENTUM, weight_decay=DECAY)
    milestones = [max(1, steps * 8 // 12), max(1, steps * 11 // 12)]
    paces = [
        torch.optim.lr_scheduler.LinearLR(optimiser, 1e-3, total_iters=min(WARM, max(1, steps // 2))),
        torch.optim.lr_scheduler.MultiStepLR(optimiser, milestones),
    ]
    losses = []
    for step, (pictures, targets) in zip(range(steps), endless(data, batch), strict=False):
        given = [{key: value.to(device) for key, value in target.items()} for target in targets]
        parts = model([picture.to(device) for picture in pictures], given)
        loss = sum(parts.values())
        optimiser.zero_grad()
        loss.backward()
        optimiser.step()
        for pace in paces:
            pace.step()
        losses.append(float(loss.detach()))
        if step % max(1, steps // 20) == 0:
            print(f"step {step}: loss {losses[-1]:.3f}", flush=True)
    return losses


def main(words: Sequence[str] | None = None) -> list[float]:
    """Fine-tune, and write the weights with their classes as `--perception mask_rcnn:FILE` reads them."""
    parser = argparse.ArgumentParser(description=__doc__.split("\n", 1)[0])
    parser.add_argument("instances", type=Path, help="OUTPUT/TASK/instances_SPLIT.json")
    parser.add_argument("--weights", type=Path, help="weights for COCO, FILE.pth")
    parser.add_argument("--output", "-o", type=Path, default=Path("detector.pth"))
    parser.add_argument("--steps", type=int, default=20_000)
    parser.add_argument("--batch", type=int, default=2)
    parser.add_argument("--size", type=int, default=512, help="shorter side of pictures in the network")
    asked = parser.parse_args(words)
    data, names = training_set(asked.instances)
    print(f"{len(data)} pictures, {len(names)} categories")
    model = network(len(names), asked.weights, asked.size)
    losses = train(model, data, asked.steps, asked.batch)
    torch.save(model.state_dict(), asked.output)
    told = {"network": NETWORK, "classes": names, "size": asked.size}
    asked.output.with_suffix(".json").write_text(json.dumps(told))
    print(f"wrote {asked.output}")
    return losses


if __name__ == "__main__":
    main()
