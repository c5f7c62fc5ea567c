"""Detectors that are asked in words: real loading code on tiny models with random weights, and masks from depth."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from hazard_ms.evaluation.result import EpisodeResult
from hazard_ms.perception.detectors.open_vocabulary import DINO, END, SAM, SLAB, OpenVocabulary, inside, slab

HEIGHT, WIDTH = 48, 64  # of a picture [pixels]
QUERIES = 8  # boxes that the small GroundingDINO proposes
LONGEST = 16  # tokens of a name, as in OWLv2
WORDS = ("apple", "coffee_maker", "table")


def letters() -> list[str]:
    return [*"abcdefghijklmnopqrstuvwxyz"]


def owl(folder: Path) -> None:
    """An OWLv2 with two layers that reads single letters."""
    transformers: Any = pytest.importorskip("transformers")
    import json

    folder.mkdir(parents=True)
    signs = ["!", "<|startoftext|>", "<|endoftext|>", *letters(), *(f"{c}</w>" for c in letters())]
    (folder / "vocab.json").write_text(json.dumps({sign: i for i, sign in enumerate(signs)}))
    (folder / "merges.txt").write_text("#version: 0.2\n")
    files = [str(folder / name) for name in ("vocab.json", "merges.txt")]
    tokenizer = transformers.CLIPTokenizer(*files, pad_token="!", model_max_length=LONGEST)
    images = transformers.Owlv2ImageProcessor(size={"height": 64, "width": 64})
    small = {"hidden_size": 32, "intermediate_size": 32, "num_hidden_layers": 2, "num_attention_heads": 2}
    text = {**small, "vocab_size": len(signs), "max_position_embeddings": LONGEST}
    config = transformers.Owlv2Config(
        text_config={**text, "bos_token_id": 1, "eos_token_id": 2, "pad_token_id": 0},
        vision_config={**small, "image_size": 64, "patch_size": 16},
        projection_dim=32,
    )
    transformers.Owlv2ForObjectDetection(config).save_pretrained(folder)
    transformers.Owlv2Processor(image_processor=images, tokenizer=tokenizer).save_pretrained(folder)


def finds_what_was_asked_for(made: OpenVocabulary) -> None:
    made.begin(WORDS)
    rgb = np.random.default_rng(0).integers(0, 255, (HEIGHT, WIDTH, 3)).astype(np.uint8)
    found = made.detect(rgb, np.full((HEIGHT, WIDTH), 2.0, np.float32))
    assert found and {d.category for d in found} <= set(WORDS)
    for detection in found:
        left, top, right, bottom = detection.box
        assert 0.3 <= detection.score <= 1.0 and 0 <= left < right <= WIDTH and 0 <= top < bottom <= HEIGHT
        assert detection.mask.shape == (HEIGHT, WIDTH) and detection.mask.dtype == bool and detection.mask.any()


def test_what_an_owl_finds_is_of_the_categories_that_were_asked_for(tmp_path: Path) -> None:
    import torch

    owl(tmp_path / "owl")
    made = OpenVocabulary(str(tmp_path / "owl"))
    torch.manual_seed(0)
    torch.nn.init.normal_(made._finder.class_head.dense0.weight)
    last = (made._finder.class_head.logit_shift, made._finder.class_head.logit_scale, made._finder.box_head.dense2)
    for layer in last:  # so that scores are likenesses alone, and boxes are where they begin
        torch.nn.init.zeros_(layer.weight)
        torch.nn.init.zeros_(layer.bias)
    finds_what_was_asked_for(made)


def dino_and_sam(folder: Path) -> None:
    """A GroundingDINO and a SAM of one or two layers each; the first reads single letters."""
    transformers: Any = pytest.importorskip("transformers")
    (folder / DINO).mkdir(parents=True)
    signs = ["[PAD]", "[UNK]", "[CLS]", "[SEP]", "[MASK]", END, *letters(), *(f"##{c}" for c in letters())]
    (folder / DINO / "vocab.txt").write_text("\n".join(signs))
    tokenizer = transformers.BertTokenizer(str(folder / DINO / "vocab.txt"))
    small = {"hidden_size": 32, "intermediate_size": 32, "num_hidden_layers": 1, "num_attention_heads": 2}
    sides = {f"{side}_{what}": 2 for side in ("encoder", "decoder") for what in ("layers", "attention_heads")}
    config = transformers.GroundingDinoConfig(
        backbone_config=transformers.SwinConfig(
            embed_dim=16, depths=[1, 1], num_heads=[1, 2], window_size=4, image_size=64, out_features=["stage2"]
        ),
        text_config=transformers.BertConfig(vocab_size=len(signs), max_position_embeddings=256, **small),
        d_model=32,
        num_queries=QUERIES,
        num_feature_levels=2,
        **sides,
    )
    transformers.GroundingDinoForObjectDetection(config).save_pretrained(folder / DINO)
    images = transformers.GroundingDinoImageProcessor(size={"shortest_edge": 64, "longest_edge": 96})
    transformers.GroundingDinoProcessor(images, tokenizer).save_pretrained(folder / DINO)
    patches = {"image_size": 64, "patch_size": 16}
    attention = {"mlp_dim": 16, "num_hidden_layers": 1, "num_attention_heads": 2}
    sam = transformers.SamConfig(
        vision_config={**patches, **attention, "hidden_size": 16, "output_channels": 16, "num_pos_feats": 8},
        prompt_encoder_config={**patches, "hidden_size": 16, "mask_input_channels": 4},
        mask_decoder_config={**attention, "hidden_size": 16, "iou_head_hidden_dim": 16},
    )
    transformers.SamModel(sam).save_pretrained(folder / SAM)
    pictures = transformers.SamImageProcessor(size={"longest_edge": 64}, pad_size={"height": 64, "width": 64})
    transformers.SamProcessor(pictures).save_pretrained(folder / SAM)


@pytest.mark.long
@pytest.mark.render
def test_an_agent_rescues_new_objects_with_what_an_owl_finds(tmp_path: Path) -> None:
    """A whole episode by the command, on random weights: what is found is nonsense, and nothing breaks."""
    owl(tmp_path / "owl")
    where = ["-e", "HazardFire-v1", "--split", "new_objects", "--episodes", "1", "--agents", "greedy"]
    seen = ["--perception", f"open:{tmp_path / 'owl'},threshold=0.3", "-o", str(tmp_path / "results")]
    subprocess.run([sys.executable, "-m", "hazard_ms.cli", "evaluate", *where, *seen], check=True)
    (path,) = (tmp_path / "results").glob("Hazard*.json")
    result = EpisodeResult.read(path)
    assert result.perception.startswith("open:") and result.ended == "time" and len(result.decisions) > 5
    names = [d.target for d in result.decisions if d.target]
    assert names and all("#" in name for name in names), "things have the names of tracks"


def test_two_models_find_and_cut_out_what_was_asked_for(tmp_path: Path) -> None:
    import torch

    torch.manual_seed(0)
    dino_and_sam(tmp_path)
    made = OpenVocabulary(str(tmp_path))
    finds_what_was_asked_for(made)


def test_the_score_of_a_name_is_the_mean_of_its_tokens(tmp_path: Path) -> None:
    """One box for which four of the five letters of `apple` speak, one for a whole name, one for a single letter."""
    import torch

    dino_and_sam(tmp_path)
    made = OpenVocabulary(str(tmp_path))
    made.begin(("apple", "coffee_maker"))
    tokens = made._asking.tokenizer
    text = tokens(f"apple{END} coffee maker{END}").input_ids
    assert tokens.convert_ids_to_tokens(text)[:3] == ["[CLS]", "a", "##p"]
    sure = torch.full((1, 3, len(text)), -20.0)
    sure[0, 0, 1:5] = 20.0  # a, p, p, l of apple
    sure[0, 1, 7:18] = 20.0  # coffee maker
    sure[0, 2, 1] = 20.0  # a
    boxes = torch.tensor([[[0.5, 0.5, 0.5, 0.5], [0.25, 0.25, 0.5, 0.5], [0.5, 0.5, 1.0, 1.0]]])
    scores, labels, found = made._grounded(SimpleNamespace(logits=sure, pred_boxes=boxes), text, (HEIGHT, WIDTH))
    assert labels.tolist() == [0, 1]
    assert scores.tolist() == pytest.approx([0.8, 1.0], abs=1e-6)
    assert found.tolist() == [[16.0, 12.0, 48.0, 36.0], [0.0, 0.0, 32.0, 24.0]]


def test_more_names_than_a_model_reads_are_asked_for_in_portions(tmp_path: Path) -> None:
    """Its text has room for 32 tokens, two of which stand around the letters and full stops of all names."""
    dino_and_sam(tmp_path)
    made = OpenVocabulary(str(tmp_path))
    made._finder.config.max_text_len = 32
    made.begin(("apple", "coffee_maker", "table", "banana", "book"))
    letters = [sum(len(word.replace(" ", "")) + 1 for word in portion) for portion in made._portions]
    assert [*map(list, made._portions)] == [["apple", "coffee maker", "table"], ["banana", "book"]]
    assert letters == [6 + 12 + 6, 7 + 5]
    found = made.detect(np.zeros((HEIGHT, WIDTH, 3), np.uint8), np.full((HEIGHT, WIDTH), 2.0, np.float32))
    assert len(found) <= 2 * QUERIES


def test_folders_without_models_are_refused(tmp_path: Path) -> None:
    pytest.importorskip("transformers")
    with pytest.raises(ValueError, match="path must be a folder with an OWLv2 model, or with grounding_dino and sam"):
        OpenVocabulary(str(tmp_path))
    (tmp_path / "config.json").write_text("{}")
    with pytest.raises(ValueError, match="must hold a transformers model"):
        OpenVocabulary(str(tmp_path))


def test_without_transformers_it_says_what_to_install(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(__import__("sys").modules, "transformers", None)
    with pytest.raises(
        ValueError, match="perception open needs the package transformers, which is not installed: pip install"
    ):
        OpenVocabulary(str(tmp_path))


def test_a_mask_is_what_is_as_far_as_the_middle_of_the_box() -> None:
    depth = np.full((HEIGHT, WIDTH), 3.0, np.float32)
    depth[10:20, 10:20] = 2.0
    depth[12, 12], depth[13, 13] = 2.0 + SLAB - 0.01, 2.0 + SLAB + 0.01
    mask = slab(depth, (8.0, 8.0, 22.0, 22.0))
    expected = np.zeros((HEIGHT, WIDTH), bool)
    expected[10:20, 10:20] = True
    expected[13, 13] = False
    assert (mask == expected).all()
    assert slab(depth, (30.2, 30.2, 30.9, 30.9)).sum() == 1  # a single pixel


def test_the_sky_is_no_part_of_a_mask() -> None:
    """A pole of 4 pixels against the sky, whose depth is 0, and a box that holds nothing but sky."""
    depth = np.zeros((HEIGHT, WIDTH), np.float32)
    depth[10:30, 18:22] = 4.0
    mask = slab(depth, (10.0, 10.0, 30.0, 30.0))
    assert mask.sum() == 80 and mask[10:30, 18:22].all()
    assert not slab(depth, (40.0, 10.0, 60.0, 30.0)).any()


def test_boxes_are_cut_to_the_picture() -> None:
    assert inside([-3.0, 5.0, 70.0, 50.0], (HEIGHT, WIDTH)) == (0.0, 5.0, 64.0, 48.0)
