"""The address of a model, and the key for it, which is never told to anybody else."""

from __future__ import annotations

import os
import stat
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any
from urllib.parse import urlsplit

URL_VARIABLE, MODEL_VARIABLE = "HAZARD_MS_LLM_BASE_URL", "HAZARD_MS_LLM_MODEL"
KEY_VARIABLE, KEY_FILE_VARIABLE = "HAZARD_MS_LLM_KEY", "HAZARD_MS_LLM_KEY_FILE"
# addresses of the scripted server, and of a small model, which are then started in this process
SCRIPTED, LOCAL = "scripted", "local"
LOOPBACK = ("127.0.0.1", "localhost", "::1")
HIDDEN = "[key]"  # what is shown in place of a key
SHORTEST_KEY = 6  # characters: anything shorter would be hidden in ordinary words [ours]


@dataclass(frozen=True)
class Endpoint:
    """An address, a model there, and the key for it, which no text of this object shows."""

    base_url: str
    model: str
    key: str = field(default="", repr=False)

    @property
    def host(self) -> str:
        """The host of the address."""
        return urlsplit(self.base_url).hostname or ""

    @property
    def local(self) -> bool:
        """Whether the model is on this machine."""
        return self.host in LOOPBACK

    def hide(self, what: Any) -> Any:
        """The same text, or the same nest of lists and dicts, without the key."""
        if not self.key:
            return what
        if isinstance(what, str):
            return what.replace(self.key, HIDDEN)
        if isinstance(what, list):
            return [self.hide(each) for each in what]
        if isinstance(what, dict):
            return {self.hide(name): self.hide(each) for name, each in what.items()}
        return what


def endpoint(base_url: str, model: str) -> Endpoint:
    """The endpoint with this address and model, or with those of the environment where they are empty.

    The key is the value of HAZARD_MS_LLM_KEY, or the content of the file that HAZARD_MS_LLM_KEY_FILE names. Raises
    ValueError for what is missing, and for an address that would show the key to others.
    """
    address = (base_url or os.environ.get(URL_VARIABLE, "")).rstrip("/")
    name = model or os.environ.get(MODEL_VARIABLE, "")
    if not address:
        raise ValueError(
            f"base_url must be the address of a server, such as http://127.0.0.1:8000/v1, {SCRIPTED} or {LOCAL}, "
            f"got none; give it as llm:base_url=...,model=... or in {URL_VARIABLE}"
        )
    if address == SCRIPTED:
        from hazard_ms.agents.llm.scripted import shared_server

        return Endpoint(shared_server(), name or "greedy")
    if address == LOCAL:
        from hazard_ms.agents.llm.local import local_server, weights

        return Endpoint(local_server()[0], name or weights().stem)
    if not name:
        raise ValueError(f"model must name a model that {address} serves, got none; give one, or set {MODEL_VARIABLE}")
    made = Endpoint(address, name, _key())
    parts = urlsplit(address)
    if parts.username or parts.password or parts.query:
        raise ValueError(
            "base_url must not contain a user name, a password or a query, got one of them; give the key in "
            f"{KEY_VARIABLE}"
        )
    if parts.scheme not in ("http", "https") or not parts.hostname:
        raise ValueError(f"base_url must begin with https:// or http:// and a host, got {address!r:.100}")
    if parts.scheme == "http" and made.key and not made.local:
        raise ValueError(
            f"base_url must begin with https:// when a key is sent to another machine, got http://{parts.hostname}"
        )
    return made


def _key() -> str:
    """The key of the environment, or of the file that it names; empty if there is none."""
    key = os.environ.get(KEY_VARIABLE, "").strip()
    place = os.environ.get(KEY_FILE_VARIABLE, "")
    if not key and place:
        path = Path(place)
        if not path.is_file():
            raise ValueError(f"{KEY_FILE_VARIABLE} must name a file, got {place!r}")
        if path.stat().st_mode & (stat.S_IRWXG | stat.S_IRWXO):
            raise ValueError(f"{place} must be readable by its owner alone, since it holds a key: chmod 600 {place}")
        key = path.read_text(encoding="utf-8").strip()
    if key and (len(key) < SHORTEST_KEY or not key.isascii() or not key.isprintable()):
        raise ValueError(
            f"{KEY_VARIABLE} must have at least {SHORTEST_KEY} characters, all of them printable ASCII, got {len(key)} "
            "characters"
        )
    return key
