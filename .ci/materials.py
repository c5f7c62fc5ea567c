"""Write the bill of materials of a release: every package of requirements.lock, in CycloneDX's JSON, version 1.6.

./run python .ci/materials.py -o hazard_ms.cdx.json

Each component has the hashes of its files, as the lock names them, and the licence that its installed version states;
packages of other versions of Python, which are not installed here, have none. No network is needed.
"""

from __future__ import annotations

import argparse
import datetime
import importlib.metadata
import json
import re
import sys
import uuid
from collections.abc import Iterator
from pathlib import Path
from typing import Any
from urllib.parse import quote

from packaging.licenses import InvalidLicenseExpression, canonicalize_license_expression

ROOT = Path(__file__).resolve().parents[1]
sys.path.insert(0, str(ROOT))
from hazard_ms.spec.registry.version import __version__  # noqa: E402 (found by the line above)

PIN = re.compile(r"(?P<name>[\w.-]+)==(?P<version>[^\s;]+)(?: ; (?P<marker>.*?))? *(?P<hashes>(?:--hash=\S+ *)+)")
INDEX = "https://pypi.org/simple/"
LONGEST_NAME = 80  # of a licence [characters]: what is longer is its text


def purl(name: str, version: str) -> str:
    """The address of a package, https://github.com/package-url."""
    return f"pkg:pypi/{name}@{quote(version, safe='')}"


def stated(about: importlib.metadata.PackageMetadata) -> Iterator[str]:
    """Licences that the metadata of a package state, the most exact first."""
    yield from about.get_all("License-Expression") or ()
    text = (about.get_all("License") or [""])[0]
    if "\n" not in text and text not in ("", "UNKNOWN") and len(text) <= LONGEST_NAME:
        yield text
    for classifier in about.get_all("Classifier") or ():
        if classifier.startswith("License :: ") and classifier != "License :: OSI Approved":
            yield classifier.rpartition(" :: ")[2]


def licences(name: str, version: str) -> list[dict[str, Any]]:
    """The licence of a package as CycloneDX writes it; none where this version is not installed or states none."""
    try:
        about = importlib.metadata.metadata(name)
    except importlib.metadata.PackageNotFoundError:
        return []
    found = next(stated(about), None) if about["Version"] == version else None
    if found is None:
        return []
    try:
        return [{"expression": canonicalize_license_expression(found)}]
    except InvalidLicenseExpression:
        return [{"license": {"name": found}}]


def component(pin: re.Match[str]) -> dict[str, Any]:
    """A pin of the lock as a component."""
    name, version = pin["name"], pin["version"]
    hashes = [text.removeprefix("--hash=sha256:") for text in pin["hashes"].split()]
    made: dict[str, Any] = {
        "type": "library",
        "bom-ref": purl(name, version),
        "name": name,
        "version": version,
        "purl": purl(name, version),
        "externalReferences": [
            {
                "type": "distribution",
                "url": f"{INDEX}{name}/",
                "comment": "the files of this version, of which one is installed",
                "hashes": [{"alg": "SHA-256", "content": content} for content in hashes],
            }
        ],
    }
    if found := licences(name, version):
        made["licenses"] = found
    if pin["marker"]:
        made["properties"] = [{"name": "hazard_ms:marker", "value": pin["marker"]}]
    return made


def bill(lock: str) -> dict[str, Any]:
    """The bill of the text of a lock. Raises ValueError for a line that is no pin with hashes."""
    lines = [line for line in lock.replace("\\\n", " ").splitlines() if line.strip()]
    pins = [PIN.fullmatch(line) for line in lines]
    for line, pin in zip(lines, pins, strict=True):
        if pin is None:
            raise ValueError(f"a line of the lock must be NAME==VERSION with hashes, got {line[:100]!r}")
    ours = purl("hazard-ms", __version__)
    return {
        "$schema": "http://cyclonedx.org/schema/bom-1.6.schema.json",
        "bomFormat": "CycloneDX",
        "specVersion": "1.6",
        "serialNumber": f"urn:uuid:{uuid.uuid5(uuid.NAMESPACE_URL, ours + lock)}",
        "version": 1,
        "metadata": {
            "timestamp": datetime.datetime.now(datetime.timezone.utc).isoformat(timespec="seconds"),
            "component": {
                "type": "library",
                "bom-ref": ours,
                "name": "hazard_ms",
                "version": __version__,
                "purl": ours,
            },
        },
        "components": [component(pin) for pin in pins if pin],
    }


def main() -> int:
    """Write the file that the command line names."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--lock", type=Path, default=ROOT / "requirements.lock", help="the lock to read")
    parser.add_argument("-o", "--out", type=Path, required=True, help="the file to write")
    options = parser.parse_args()
    made = bill(options.lock.read_text(encoding="utf-8"))
    options.out.write_text(json.dumps(made, indent=1) + "\n", encoding="utf-8")
    without = sum("licenses" not in part for part in made["components"])
    print(f"{len(made['components'])} components, {without} of them without a licence: {options.out}")
    return 0


if __name__ == "__main__":
    sys.exit(main())
