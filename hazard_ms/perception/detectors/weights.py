"""Files of weights and what lies beside them, which somebody else may have made."""

from __future__ import annotations

import io
import pickletools
import zipfile
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import torch

from hazard_ms.perception.options import LARGEST
from hazard_ms.spec.catalogue import CATEGORIES
from hazard_ms.spec.checks import one_of, whole
from hazard_ms.spec.foreign import plain
from hazard_ms.spec.foreign.arrays import check_archive
from hazard_ms.spec.foreign.files import printable, read_foreign

LARGEST_RECIPE = 1_000_000  # [bytes] [ours]
LARGEST_WEIGHTS = 400_000_000  # [bytes]; the largest network here has 186 million, with its optimiser twice as many
LARGEST_PICKLE = 10_000_000  # that tells how tensors lie in a file .pth [bytes] [ours]
COUNTS = "num_batches_tracked"  # the only weights that are whole numbers
# what torch.save writes of tensors; other things that weights_only allows could ask for any amount of memory
NAMED = {"collections OrderedDict", "torch._utils _rebuild_tensor_v2", "torch._utils _rebuild_parameter"}
NAMED |= {f"torch {kind}Storage" for kind in ("Float", "Half", "BFloat16", "Double", "Long", "Int", "Bool", "Byte")}


def read_recipe(path: Path, networks: Sequence[str]) -> dict[str, Any]:
    """One of `networks` and its classes, from the file beside the weights. Raises ValueError for another file."""
    return checked_recipe(plain.read(path, LARGEST_RECIPE), printable(str(path)), networks)


def checked_recipe(recipe: Any, what: str, networks: Sequence[str]) -> dict[str, Any]:
    """The `recipe`, called `what` in errors. Raises ValueError if it does not name one of `networks` and classes."""
    if not isinstance(recipe, dict) or recipe.get("network") not in networks or "classes" not in recipe:
        told = {k: recipe.get(k) for k in ("network", "classes")} if isinstance(recipe, dict) else recipe
        raise ValueError(
            f"{what} must hold the network {' or '.join(networks)} and its classes, got {printable(repr(told)[:200])}"
        )
    classes = recipe["classes"]
    if not isinstance(classes, list) or not classes or len(set(map(str, classes))) < len(classes):
        raise ValueError(f"classes in {what} must be a list of distinct categories, got {classes!r:.100}")
    for name in classes:
        one_of(name, CATEGORIES, f"a class in {what}")
    if recipe.get("size") is not None:
        whole(recipe["size"], 1, LARGEST, f"size in {what}")
    return recipe


def read_weights(path: Path) -> dict[str, torch.Tensor]:
    """The weights in a file .pth or .safetensors, [...] [-], by name. Raises ValueError for other files."""
    if path.suffix == ".safetensors":
        from safetensors.torch import load

        content = read_foreign(path, LARGEST_WEIGHTS)
        try:
            weights = load(content)
        except Exception as error:  # of several kinds
            raise _refused(path, error) from None
    else:
        weights = read_saved(path)
    _check(weights, printable(str(path)))
    return weights


def read_saved(path: Path) -> Any:
    """The plain data and tensors that torch.save wrote. Raises ValueError for other files, and other things in them."""
    content = read_foreign(path, LARGEST_WEIGHTS)
    try:
        if content.startswith(b"PK"):
            check_archive(content, str(path), LARGEST_WEIGHTS)
        _check_names(content)
        return torch.load(io.BytesIO(content), map_location="cpu", weights_only=True)
    except Exception as error:  # torch raises many kinds for what is no file of weights
        raise _refused(path, error) from None


def _check_names(content: bytes) -> None:
    """Check that pickles in a file of torch name nothing but tensors. Raises ValueError for others."""
    pickles = io.BytesIO(content)
    count = 4  # of torch before 1.6: a mark, its version, facts about the machine, and the weights
    if content.startswith(b"PK"):
        with zipfile.ZipFile(pickles) as archive:
            (info,) = (m for m in archive.infolist() if m.filename.endswith("/data.pkl"))
            if info.file_size > LARGEST_PICKLE:
                raise ValueError(f"a list of tensors must have at most {LARGEST_PICKLE} bytes, got {info.file_size}")
            pickles, count = io.BytesIO(archive.read(info)), 1
    for _ in range(count):
        for code, told, place in pickletools.genops(pickles):
            named = code.name in ("GLOBAL", "INST", "STACK_GLOBAL") or code.name.startswith("EXT")
            if (named and str(told) not in NAMED) or (count > 1 and place is not None and place > len(content)):
                raise ValueError(f"only tensors may be in it, got {printable(str(told or code.name))[:100]}")


def _check(weights: Any, what: str) -> None:
    """Check that `weights` are tensors of finite numbers. Raises ValueError that calls their file `what`."""
    if not isinstance(weights, Mapping) or not all(isinstance(value, torch.Tensor) for value in weights.values()):
        raise ValueError(f"weights must map names to tensors, got {type(weights).__name__} in {what}")
    for name, value in weights.items():
        shown = printable(str(name))[:100]
        if value.layout != torch.strided or value.numel() * value.element_size() > value.untyped_storage().nbytes():
            raise ValueError(f"weights must be plain tensors, got {shown} of shape {tuple(value.shape)} in {what}")
        if not value.is_floating_point() and not str(name).endswith(COUNTS):
            raise ValueError(f"weights must be floating-point numbers, got {value.dtype} for {shown} in {what}")
        if not bool(torch.isfinite(value).all()):
            raise ValueError(f"weights must be finite, got NaN or infinity for {shown} in {what}")


def _refused(path: Path, error: Exception) -> ValueError:
    return ValueError(
        f"weights must be a file .pth or .safetensors, got {printable(str(path))}: {printable(repr(error))[:200]}"
    )
