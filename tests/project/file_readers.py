"""Which module of the package reads files, or what files hold, by which calls: all but the gate in spec/foreign."""

from __future__ import annotations

import ast
from collections.abc import Iterator
from pathlib import Path

# calls that read, by their full names; "x.*": every function of a module
READING = (
    *("json.load", "json.loads", "json.JSONDecoder", "pickle.*", "marshal.*", "shelve.*", "yaml.*", "tomllib.*"),
    *("numpy.load", "numpy.memmap", "numpy.fromfile", "numpy.loadtxt", "numpy.genfromtxt"),
    *("torch.load", "torch.jit.load", "safetensors.safe_open", "safetensors.deserialize", "safetensors.torch.load"),
    *("safetensors.torch.load_file", "safetensors.numpy.load", "safetensors.numpy.load_file"),
    *("cv2.imread", "cv2.imdecode", "cv2.VideoCapture", "PIL.Image.open", "av.open", "imageio.*", "trimesh.load"),
    *("sqlite3.connect", "h5py.File", "pyarrow.parquet.read_table", "pyarrow.parquet.ParquetFile"),
    *("zipfile.*", "tarfile.open", "tarfile.TarFile", "gzip.*", "bz2.*", "lzma.*", "zlib.decompress"),
    *("zlib.decompressobj", "xml.etree.ElementTree.parse", "xml.etree.ElementTree.fromstring", "csv.reader"),
    *("csv.DictReader", "os.open", "os.fdopen", "io.open", "mmap.mmap", "open"),
)
METHODS = ("read_text", "read_bytes", "open", "from_pretrained")  # of whatever object
MODES = ("w", "a", "x")  # of files that are only written, without "+"
GATE = "spec.foreign"


def readers(path: Path) -> Iterator[str]:
    """The calls of a file that read, by their full names, or ".open" for those of an object."""
    tree = ast.parse(path.read_text())
    names = _names(tree)
    for node in ast.walk(tree):
        if isinstance(node, ast.Call) and (called := _called(node, names)) and not _only_writes(node, called):
            yield called


def _names(tree: ast.AST) -> dict[str, str]:
    """What each imported name stands for."""
    found: dict[str, str] = {}
    for node in ast.walk(tree):
        if isinstance(node, ast.Import):
            for alias in node.names:
                found[alias.asname or alias.name.split(".")[0]] = (
                    alias.name if alias.asname else alias.name.split(".")[0]
                )
        elif isinstance(node, ast.ImportFrom):
            found |= {alias.asname or alias.name: f"{node.module}.{alias.name}" for alias in node.names}
    return found


def _called(node: ast.Call, names: dict[str, str]) -> str:
    """The name of a call that reads; empty for others."""
    parts: list[str] = []
    at = node.func
    while isinstance(at, ast.Attribute):
        parts.insert(0, at.attr)
        at = at.value
    if isinstance(at, ast.Name) and (at.id in names or not parts):
        full = ".".join((names.get(at.id, at.id), *parts))
        if full.startswith("hazard_ms."):
            return ""  # a function of ours, which is judged where it stands
        if any(full == each or (each.endswith(".*") and full.startswith(each[:-1])) for each in READING):
            return full
        if at.id in names and full.split(".")[0] not in ("pathlib", "importlib"):
            return ""  # another package's
    return f".{parts[-1]}" if parts and parts[-1] in METHODS else ""


def _only_writes(node: ast.Call, called: str) -> bool:
    """Whether a call opens a file for nothing but writing."""
    if called == "os.open":
        return "O_WRONLY" in ast.unparse(node)
    if not called.endswith(("open", "File")):
        return False
    place = 0 if called.startswith(".") else 1
    words = [*node.args[place : place + 1], *(word.value for word in node.keywords if word.arg == "mode")]
    modes = [str(word.value) for word in words if isinstance(word, ast.Constant)]
    return any(mode.startswith(MODES) and "+" not in mode for mode in modes)
