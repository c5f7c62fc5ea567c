"""Labelled pictures, detections, detectors and their trainings as a stranger may send them, and answers of models."""

from __future__ import annotations

import contextlib
import json
import shutil
from pathlib import Path
from typing import Any

import httpx2
import torch

from hazard_ms.agents.llm import answers
from hazard_ms.agents.llm.choices import Choice, Menu
from hazard_ms.agents.llm.client import Client
from hazard_ms.agents.llm.endpoint import Endpoint
from hazard_ms.agents.llm.network.faults import NoAnswerError, RefusedError
from hazard_ms.agents.llm.network.transport import Bounded
from hazard_ms.perception import card, check, layout, rows, score, show
from hazard_ms.perception.detectors.mask_rcnn import NETWORKS, network
from hazard_ms.perception.detectors.small import NETWORK, SHIPPED, Small
from hazard_ms.perception.detectors.weights import checked_recipe, read_recipe, read_saved, read_weights
from hazard_ms.perception.training import pictures
from hazard_ms.skills.decision import Action
from tests.worlds.drawn_pictures import draw

RESNET18 = NETWORKS[-1]
IMAGE = {"seed": 0, "room": "kitchen_a", "lighting": "day", "effects": "full", "hazard_visible": True}
PROMPT = [{"role": "user", "content": "Choose."}]


def make_captured(folder: Path) -> None:
    """A drawn dataset with all that captured ones have."""
    draw(folder, "test", 2, 48)
    path = folder / layout.instances("test")
    told = json.loads(path.read_text())
    names = {row["id"]: row["name"] for row in told["categories"]}
    for number, image in enumerate(told["images"]):
        image.update(IMAGE, frame=number, hazard_file=image["depth_file"])
    for row in told["annotations"]:
        row.update(name=names[row["category_id"]])
    path.write_text(json.dumps({**told, "info": {"recipe": {"env_id": "HazardFire-v1"}}}))
    names = [str(p.relative_to(folder)) for p in folder.rglob("*") if p.is_file()]
    (folder / layout.SUMS).write_text(layout.sums_of(folder, names))


def read_captured(folder: Path) -> None:
    """As one of the commands that read datasets does, chosen by the folder's number; honest ones by all of them."""
    path = folder / layout.instances("test")

    def learnt() -> None:
        for picture in pictures.read([folder], "test"):
            picture.rgb(), picture.ids(), picture.depth(), picture.intrinsic(), picture.cam2world()

    def scored() -> None:
        (folder / "none.json").write_text("[]")
        score.score(folder, folder / "none.json", "test")

    ways = (
        lambda: check.check(folder),
        lambda: card.card(folder),
        lambda: show.show(folder, folder / "page.html", 2, 2),
        lambda: layout.read_instances(path, rows.SCORED),
        learnt,
        scored,
    )
    for way in [ways[int(folder.name) % len(ways)]] if folder.name.isdigit() else ways:
        way()


def make_detections(folder: Path) -> None:
    data = draw(folder / "data", "test", 1, 48)
    truth = json.loads((data / layout.instances("test")).read_text())
    found = [{**{k: row[k] for k in ("image_id", "category_id", "bbox")}, "score": 0.5} for row in truth["annotations"]]
    found = [{**row, "segmentation": of["segmentation"]} for row, of in zip(found, truth["annotations"], strict=True)]
    shutil.rmtree(data)
    (folder / "found.json").write_text(json.dumps(found))


def read_detections(folder: Path) -> None:
    truth = {"images": [], "annotations": [], "categories": layout.categories()}
    with contextlib.suppress(ValueError):
        score.read_results(folder / "found.json", truth)
    truth["images"] = [{"id": 1, "width": 48, "height": 48}]
    for kind in ("bbox", "segm"):
        score.table(truth, score.read_results(folder / "found.json", truth), kind)


def make_detectors(folder: Path) -> None:
    torch.manual_seed(0)
    shutil.copyfile(SHIPPED, folder / "small.safetensors")
    shutil.copyfile(SHIPPED.with_suffix(".json"), folder / "small.json")
    torch.save({"a.weight": torch.ones(3, 2)}, folder / "other.pth")
    recipe = {"network": RESNET18, "classes": ["apple", "box"], "size": 64}
    (folder / "other.json").write_text(json.dumps(recipe))
    torch.save({"command": "none", "recipe": recipe, "weights": {"a": torch.ones(3)}}, folder / "one.training")


def read_detectors(folder: Path) -> None:
    refusals = []

    def other() -> None:
        recipe = read_recipe(folder / "other.json", NETWORKS)
        network(recipe["network"], 1 + len(recipe["classes"]), recipe.get("size"))
        read_weights(folder / "other.pth")

    def training() -> None:
        found = read_saved(folder / "one.training")
        if not isinstance(found, dict):
            raise ValueError("the state must be an object")
        checked_recipe(found.get("recipe"), "the recipe", (*NETWORKS, NETWORK))

    for way in (lambda: Small(str(folder / "small.safetensors")), other, training):
        try:
            way()
        except ValueError as error:
            refusals.append(error)
    if refusals:
        raise refusals[0]


def make_reply(folder: Path) -> None:
    message = {"role": "assistant", "content": '{"reason": "near", "choice": "A"}', "reasoning": "Which?"}
    tops = [{"token": "A", "logprob": -0.1}, {"token": "B", "logprob": -3.0}]
    choice = {"message": message, "finish_reason": "stop", "logprobs": {"content": [{**tops[0], "top_logprobs": tops}]}}
    usage = {"prompt_tokens": 10, "completion_tokens": 5}
    (folder / "body.json").write_text(json.dumps({"id": "1", "choices": [choice], "usage": usage}))


def read_reply(folder: Path) -> None:
    """Ask a server that sends the file as its answer, or as an error, and read it in each way."""
    content, path = b"", folder / "body.json"
    if path.is_file() and not path.is_symlink():
        with path.open("rb") as file:
            content = file.read(2_000_000)
    menu = Menu((Choice("A", "stop", None, Action("stop")), Choice("B", "explore", None, Action("explore"))), ())
    for status in (200, 400, 503):
        client = Client(Endpoint("http://127.0.0.1:9/v1", "any"), 1, 0)

        def answer(request: Any, status: int = status) -> Any:
            return httpx2.Response(status, content=content, headers={"content-type": "application/json"})

        client._connection._inner = httpx2.MockTransport(answer)
        assert isinstance(client._connection, Bounded)
        try:
            body = client.ask({"model": "any", "messages": PROMPT}, 5.0)
        except (NoAnswerError, RefusedError) as error:
            if status == 200:
                raise ValueError(str(error)) from None
            continue
        reply = answers.reply_of(body, 1.0, "Choose.")
        for way in answers.WAYS:
            with contextlib.suppress(answers.UnreadableError):
                answers.read(way, reply, menu, {"A": "stop", "B": "look around"})
