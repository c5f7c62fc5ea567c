"""Files of a release: how to cite, the checks before a commit, and the bill of materials."""

from __future__ import annotations

import json
import re
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest
import yaml

from hazard_ms.spec.registry.version import __version__
from tests.worlds.files.checkout import ROOT, THIS_PYTHON, locked, pins

# Of the schema of CFF 1.2.0, https://github.com/citation-file-format/citation-file-format: what is required, and may be
REQUIRED = {"authors", "cff-version", "message", "title"}
MAY_BE = REQUIRED | {
    *("abstract", "commit", "contact", "date-released", "doi", "identifiers", "keywords", "license", "license-url"),
    *("preferred-citation", "references", "repository", "repository-artifact", "repository-code", "type", "url"),
    "version",
}
WORK = {"authors", "title", "type"}  # required of a reference
MATERIALS = ROOT / ".ci/materials.py"


def citation() -> dict[str, Any]:
    """CITATION.cff as data."""
    return yaml.safe_load((ROOT / "CITATION.cff").read_text(encoding="utf-8"))


def faults(cited: dict[str, Any]) -> set[str]:
    """Keys that a citation lacks or that CFF 1.2.0 does not know, and values of another kind."""
    wrong = (REQUIRED - set(cited)) | (set(cited) - MAY_BE)
    wrong |= {key for key in ("message", "title", "version", "abstract") if not isinstance(cited.get(key, ""), str)}
    for number, work in enumerate(cited.get("references", ())):
        wrong |= {f"references/{number}/{key}" for key in WORK - set(work)}
    for author in [*cited.get("authors", ()), *(a for work in cited.get("references", ()) for a in work["authors"])]:
        if not set(author) & {"name", "family-names"}:
            wrong.add(f"author {author}")
    return wrong


def test_the_citation_is_one_of_cff_1_2_0() -> None:
    cited = citation()
    assert faults(cited) == set() and cited["cff-version"] == "1.2.0" and cited["type"] == "software"
    assert faults({**cited, "writers": []}) == {"writers"} and faults({"version": 1.0}) == REQUIRED | {"version"}


def test_the_citation_is_of_this_version_and_names_the_challenge() -> None:
    cited = citation()
    assert cited["version"] == __version__ and cited["license"] == "Apache-2.0"
    (paper,) = [work for work in cited["references"] if work["title"].startswith("HAZARD Challenge")]
    assert paper["authors"][0]["family-names"] == "Zhou" and len(paper["authors"]) == 9 and paper["year"] == 2024
    assert "ICLR 2024" in paper["conference"]["name"] and "arXiv:2401.12975" in str(paper["identifiers"])


def test_commits_are_checked_with_what_the_tests_check_with() -> None:
    """The hooks run in the environment of the lock, and are those that stand before pytest in `./run test`."""
    (source,) = yaml.safe_load((ROOT / ".pre-commit-config.yaml").read_text(encoding="utf-8"))["repos"]
    assert source["repo"] == "local", "a hook from elsewhere has a version of its own"
    entries = [hook["entry"].removeprefix("./run python -m ") for hook in source["hooks"]]
    before = re.search(r"^ *\"  \".*?\) (.*?) \|\| exit 1", (ROOT / "run").read_text(), re.M)
    assert before
    checks = [" ".join(re.findall(r"^\w+(?: \w+)?", command)) for command in before[1].split(" && ")]
    assert [re.sub(" --force-exclude$", "", entry) for entry in entries] == checks
    assert all(hook["language"] == "system" and hook["entry"].startswith("./run python") for hook in source["hooks"])
    for hook, entry in zip(source["hooks"], entries, strict=True):
        assert entry.split()[0] in locked(THIS_PYTHON)
        # without it, ruff checks files that a commit names though pyproject.toml excludes them
        assert entry.endswith("--force-exclude") or hook["pass_filenames"] is False


def make_bill(lock: Path, out: Path) -> subprocess.CompletedProcess[str]:
    """The command that writes the bill of materials of a lock."""
    command = [sys.executable, str(MATERIALS), "--lock", str(lock), "-o", str(out)]
    return subprocess.run(command, capture_output=True, text=True, check=False, cwd=out.parent)


def test_the_bill_of_materials_holds_every_package_of_the_lock(tmp_path: Path) -> None:
    lock, out = ROOT / "requirements.lock", tmp_path / "bill.json"
    done = make_bill(lock, out)
    assert done.returncode == 0, done.stderr
    bill = json.loads(out.read_text())
    assert (bill["bomFormat"], bill["specVersion"], bill["version"]) == ("CycloneDX", "1.6", 1)
    assert bill["metadata"]["component"]["version"] == __version__
    parts = {f"{part['name']}=={part['version']}": part for part in bill["components"]}
    wanted = re.findall(r"^[\w.-]+==[^\s;]+", lock.read_text(), re.M)
    assert wanted and sorted(parts) == sorted(wanted) and len(bill["components"]) == len(wanted)
    assert len({part["bom-ref"] for part in parts.values()}) == len(parts)
    for requirement, marker, hashes in pins(lock.read_text()):
        part = parts[requirement]
        assert part["purl"] == f"pkg:pypi/{requirement.replace('==', '@').replace('+', '%2B')}"
        told = {f"--hash=sha256:{entry['content']}" for entry in part["externalReferences"][0]["hashes"]}
        assert (
            told == set(hashes) and [entry["value"] for entry in part.get("properties", ())] == [marker][: bool(marker)]
        )
    installed = [parts[f"{name}=={version}"] for name, version in locked(THIS_PYTHON).items()]
    assert parts[f"gymnasium=={locked(THIS_PYTHON)['gymnasium']}"]["licenses"] == [{"license": {"name": "MIT License"}}]
    assert sum("licenses" in part for part in installed) > 0.9 * len(installed)


@pytest.mark.parametrize("line", ["thing>=1.0 --hash=sha256:00\n", "thing==1.0\n", "-e .\n"])
def test_a_lock_that_does_not_pin_has_no_bill(tmp_path: Path, line: str) -> None:
    (tmp_path / "lock").write_text(line)
    done = make_bill(tmp_path / "lock", tmp_path / "bill.json")
    assert done.returncode == 1 and f"must be NAME==VERSION with hashes, got {line.strip()!r}" in done.stderr
    assert not (tmp_path / "bill.json").exists()
