"""Objects and modules by text: what entries of the registry name, and third parties' files that register more."""

from __future__ import annotations

import hashlib
import importlib
import importlib.util
import sys
from pathlib import Path
from types import ModuleType
from typing import Any


def load(what: Any) -> Any:
    """The object that `what` names as "package.module:attribute"; anything but text is returned as it is.

    Raises ValueError if there is no such module or attribute.
    """
    if not isinstance(what, str):
        return what
    module_name, _, attribute = what.partition(":")
    if not module_name or not attribute:
        raise ValueError(f"an entry must be package.module:attribute, got {what!r}")
    try:
        return getattr(importlib.import_module(module_name), attribute)
    except ModuleNotFoundError as missing:
        raise ValueError(f"{what!r} must name a module that can be imported; {missing}") from missing
    except AttributeError as missing:
        raise ValueError(f"{what!r} must name an attribute of {module_name}; {missing}") from missing


def load_plugin(text: str) -> ModuleType:
    """Run a third party's module, which registers what it brings: a file "folder/name.py", or "package.module".

    A file is run once, however often it is loaded. Raises ValueError if there is no such file or module.
    """
    if not text.endswith(".py"):
        try:
            return importlib.import_module(text)
        except (ModuleNotFoundError, TypeError) as missing:
            raise ValueError(f"load must be a file NAME.py or a module, got {text!r}: {missing}") from missing
    path = Path(text).resolve()
    name = f"hazard_ms_plugin_{path.stem}_{hashlib.sha256(str(path).encode()).hexdigest()[:8]}"
    if name in sys.modules:
        return sys.modules[name]
    spec = importlib.util.spec_from_file_location(name, path)
    if spec is None or spec.loader is None or not path.is_file():
        raise ValueError(f"load must be a file that exists, got {text!r}")
    module = sys.modules[name] = importlib.util.module_from_spec(spec)
    try:
        spec.loader.exec_module(module)
    except BaseException:
        del sys.modules[name]
        raise
    return module
