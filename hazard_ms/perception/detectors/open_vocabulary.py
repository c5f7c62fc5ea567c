"""Detectors that are asked in words, from models that the user has on disk: they know things nobody trained them on.

FOLDER holds either an OWLv2 model, whose boxes are filled where the depth is about that of their middle, or two
folders, `grounding_dino` and `sam`: boxes from words, and masks from boxes. Each is a folder that `save_pretrained` of
Hugging Face's transformers wrote; nothing is downloaded.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import torch
import torchvision
from numpy.typing import NDArray

from hazard_ms.sensing.detection.detector import Box, Detection, Detector
from hazard_ms.spec.catalogue import CATEGORIES

BOX_SCORE = 0.3  # least score of a box, as GroundingDINO's authors use it
END = "."  # ends each name in the text that GroundingDINO reads
AROUND = 2  # tokens that stand around that text
SAME = 0.7  # overlap from which two boxes are of one thing, if they were found under different names [ours]
SLAB = 0.3  # difference in depth from the middle of a box within which pixels belong to its thing [m] [ours]
DINO, SAM = "grounding_dino", "sam"  # folders


class OpenVocabulary(Detector):
    """OWLv2, or GroundingDINO with SAM. Scores are from BOX_SCORE on, so give `threshold` with it."""

    def __init__(self, path: str) -> None:
        """Load the models in the folder `path`. Raises ValueError where they, or transformers, are missing."""
        try:
            import transformers
        except ImportError:
            raise ValueError(
                "perception open needs the package transformers, which is not installed: pip install transformers"
            ) from None
        folder = Path(path)
        both = (folder / DINO).is_dir() and (folder / SAM).is_dir()
        if not both and not (folder / "config.json").is_file():
            raise ValueError(f"path must be a folder with an OWLv2 model, or with {DINO} and {SAM}, got {folder}")
        self._device = torch.device("cuda" if torch.cuda.is_available() else "cpu")
        finder = transformers.AutoModelForZeroShotObjectDetection
        self._finder, self._asking = self._loaded(finder, transformers.AutoProcessor, folder / DINO if both else folder)
        self._masker: Any = None
        self._cutting: Any = None
        if both:
            self._masker, self._cutting = self._loaded(transformers.SamModel, transformers.SamProcessor, folder / SAM)
        self._portions: list[dict[str, str]] = []  # categories by their words, in portions that a model reads at once

    def _loaded(self, model: Any, processor: Any, folder: Path) -> tuple[Any, Any]:
        """A model and its processor from a folder. Raises ValueError for a folder that does not hold them."""
        try:
            # a folder may come from strangers: no code of its own is run, and no pickle is read
            made = model.from_pretrained(folder, local_files_only=True, trust_remote_code=False, use_safetensors=True)
            read = processor.from_pretrained(folder, local_files_only=True, trust_remote_code=False)
            return made.to(self._device).eval(), read
        except (OSError, ValueError, KeyError) as error:
            raise ValueError(f"{folder} must hold a transformers model, got {error!r:.200}") from None

    def begin(self, categories: tuple[str, ...]) -> None:
        """Look for things of `categories`, in words; in several portions where the model reads no longer text."""
        names = {CATEGORIES[name].label: name for name in categories}
        self._portions = [names]
        if self._masker is not None:
            self._portions, left = [], 0
            for word, name in names.items():
                length = len(self._asking.tokenizer(word + END, add_special_tokens=False).input_ids)
                if length > left:
                    self._portions.append({})
                    left = self._finder.config.max_text_len - AROUND
                self._portions[-1][word] = name
                left -= length

    @torch.inference_mode()
    def detect(self, rgb: NDArray[np.uint8], depth: NDArray[np.float32]) -> list[Detection]:
        """Find things of the episode's categories in the colours `rgb`, [H, W, 3], and the `depth`, [H, W] [m]."""
        kept = [found for names in self._portions for found in self._found(rgb, names)]
        if len(self._portions) > 1 and kept:  # a thing may have been found under a name of each portion
            boxes, scores = torch.tensor([box for _, _, box in kept]), torch.tensor([score for _, score, _ in kept])
            kept = [kept[k] for k in torchvision.ops.nms(boxes, scores, SAME).tolist()]
        masks = self._masks(rgb, depth, [box for _, _, box in kept])
        pairs = zip(kept, masks, strict=True)
        return [Detection(name, score, box, mask) for (name, score, box), mask in pairs if mask.any()]

    def _found(self, rgb: NDArray[np.uint8], names: dict[str, str]) -> list[tuple[str, float, Box]]:
        """Category, score and box of what is called by one of `names`, which are categories by their words."""
        words, shape = list(names), rgb.shape[:2]
        given = self._asking(images=rgb, text=[words], return_tensors="pt").to(self._device)
        output = self._finder(**given)
        if self._masker is None:
            (found,) = self._asking.post_process_grounded_object_detection(
                output, threshold=BOX_SCORE, target_sizes=torch.tensor([shape]), text_labels=[words]
            )
            named, scores, boxes = found["text_labels"], found["scores"], found["boxes"]
        else:
            scores, labels, boxes = self._grounded(output, given["input_ids"][0].tolist(), shape)
            named = [words[number] for number in labels.tolist()]
        every = zip(named, scores.tolist(), [inside(box, shape) for box in boxes.tolist()], strict=True)
        return [(names[n], score, box) for n, score, box in every if n in names and box[2] > box[0] and box[3] > box[1]]

    def _grounded(self, output: Any, text: list[int], shape: tuple[int, ...]) -> tuple[torch.Tensor, ...]:
        """What GroundingDINO found in a picture of the shape (H, W): scores, numbers of names, and boxes [pixels].

        The score of a name is the mean of those of its tokens in `text`, as in the authors' evaluation on COCO; labels
        made of all tokens above a threshold run names into one another.
        """
        tokens, names = self._asking.tokenizer, [list[int]()]
        for place, token in enumerate(text):
            if token == tokens.convert_tokens_to_ids(END):
                names.append([])
            elif token not in tokens.all_special_ids:
                names[-1].append(place)
        chances = output.logits[0].sigmoid()
        scores, labels = torch.stack([chances[:, name].mean(dim=1) for name in names[:-1]], dim=1).max(dim=1)
        height, width = shape
        boxes = torchvision.ops.box_convert(output.pred_boxes[0], "cxcywh", "xyxy")
        boxes, kept = boxes * boxes.new_tensor([width, height, width, height]), scores > BOX_SCORE
        return scores[kept], labels[kept], boxes[kept]

    def _masks(self, rgb: NDArray[np.uint8], depth: NDArray[np.float32], boxes: list[Box]) -> list[NDArray[np.bool_]]:
        """A mask, [H, W], for each of `boxes` [pixels]."""
        if self._masker is None or not boxes:
            return [slab(depth, box) for box in boxes]
        given = self._cutting(rgb, input_boxes=[[list(box) for box in boxes]], return_tensors="pt").to(self._device)
        output = self._masker(**given, multimask_output=False)
        (masks,) = self._cutting.image_processor.post_process_masks(
            output.pred_masks.cpu(), given["original_sizes"].cpu(), given["reshaped_input_sizes"].cpu()
        )
        return list(masks[:, 0].numpy())


def inside(box: list[float], shape: tuple[int, ...]) -> Box:
    """The part of a box [pixels] that lies in a picture of the shape (H, W)."""
    height, width = shape
    left, right = np.clip([box[0], box[2]], 0.0, width).tolist()
    top, bottom = np.clip([box[1], box[3]], 0.0, height).tolist()
    return left, top, right, bottom


def slab(depth: NDArray[np.float32], box: Box) -> NDArray[np.bool_]:
    """The pixels in a box whose `depth`, [H, W] [m], is within SLAB of the median of the middle of the box: [H, W].

    A depth of 0 means that there is nothing: it does not count, and a box whose middle is empty has no pixels.
    """
    left, top, right, bottom = int(box[0]), int(box[1]), int(np.ceil(box[2])), int(np.ceil(box[3]))
    quarter_x, quarter_y = (right - left) // 4, (bottom - top) // 4
    middle = depth[top + quarter_y : bottom - quarter_y, left + quarter_x : right - quarter_x]
    mask = np.zeros(depth.shape, bool)
    if (middle > 0.0).any():
        far = depth[top:bottom, left:right]
        mask[top:bottom, left:right] = (far > 0.0) & (np.abs(far - np.median(middle[middle > 0.0])) < SLAB)
    return mask
