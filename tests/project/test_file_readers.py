"""Files that somebody else may have made are read through hazard_ms/spec/foreign; all other readers are listed here."""

from __future__ import annotations

from pathlib import Path

from tests.project.file_readers import GATE, readers
from tests.project.imports import modules

OWN = "files of the package, or of installed packages"
SYSTEM = "files of the operating system, or programs of ours that answer"
HERE = "what this run has just written, or its own processes send"
BYTES = "content that the gate has read, with limits on what it unpacks to"
NETWORK = "a message whose size is limited before it is parsed"
LOCK = "locks and folders, whose content is not read; links are not followed"

# Module -> its calls that read, and why they need not go through the gate
KNOWN: dict[str, tuple[set[str], str]] = {
    "agents.learned.weights": ({"safetensors.torch.load", "torch.load"}, BYTES),
    "agents.llm.answers": ({"json.loads"}, NETWORK),
    "agents.llm.cache": ({"sqlite3.connect"}, "its own limits: SQLite's lengths and steps, one schema, no waiting"),
    "agents.llm.endpoint": ({".read_text"}, "the user's own key, in a file that is closed to others"),
    "agents.llm.network.extra": ({"json.loads"}, "words of the command line"),
    "agents.llm.network.transport": ({"zlib.decompressobj"}, NETWORK),
    "agents.llm.rules": ({"json.loads"}, "a prompt that this package has written"),
    "agents.llm.scripted": ({"json.loads", "PIL.Image.open"}, NETWORK),
    "scenes.assets.contact_sheet": ({"cv2.imread"}, "textures that the package or its intake has written"),
    "scenes.assets.intake.adding": ({".read_bytes", "os.open"}, HERE + "; " + LOCK),
    "scenes.assets.intake.conversion": ({".read_text", "json.loads"}, "facts of its worker, a process with limits"),
    "scenes.assets.intake.gltf": ({"json.loads"}, BYTES + ", in a process with limits"),
    "scenes.assets.intake.shaping": ({"PIL.Image.open"}, HERE),
    "scenes.assets.intake.textures": ({"PIL.Image.open"}, BYTES + ", in a process with limits"),
    "scenes.assets.intake.worker": ({"json.load"}, HERE),
    "scenes.assets.providers.base": ({"gzip.GzipFile"}, BYTES),
    "scenes.assets.providers.partnet": ({"xml.etree.ElementTree.fromstring"}, BYTES + "; entities are refused"),
    "scenes.assets.shipped": ({".read_text", "json.loads"}, OWN),
    "cli.costs.resets": ({".read_text"}, SYSTEM),
    "cli.costs.serving": ({".read_text", "json.load", "json.loads"}, SYSTEM + "; the bench's own server"),
    "demonstrations.claims": ({"os.open"}, LOCK),
    "demonstrations.export.lerobot_film": ({"av.open"}, "its own limits: format, codec and pixels, before a picture"),
    "demonstrations.export.lerobot_tables": ({"pyarrow.parquet.ParquetFile"}, HERE),
    "demonstrations.export.tar": ({".open"}, "bytes that go into an archive as they are, of a dataset with its hashes"),
    "demonstrations.store": ({"os.open"}, "the last byte of a manifest, to append to it; links are not followed"),
    "effects.shaders.pack": ({".read_text"}, OWN),
    "evaluation.averted.alone": ({"json.loads"}, "settings of this run, as a file holds them"),
    "evaluation.page": ({".read_bytes"}, "films that this run made, of a size that is asked first"),
    "evaluation.submissions.packing": ({"zipfile.ZipInfo"}, "the name of a member that is written"),
    "evaluation.sweep": ({"json.loads"}, "settings of this run, as a result holds them"),
    "simulation.kernels.compiled": ({".open", "os.open"}, "bytes that are hashed or compared; " + LOCK),
    "lerobot.hazard_client": ({"json.loads"}, NETWORK),
    "machine.activity": ({".read_text"}, SYSTEM),
    "machine.cores": ({".read_text"}, SYSTEM),
    "machine.drivers": ({".read_bytes", ".read_text"}, SYSTEM + "; a package that is compared with its SHA-256"),
    "spec.storage.files": ({".open", "os.open"}, HERE + "; " + LOCK),
    "spec.storage.parts": ({"os.open"}, LOCK),
    "machine.render_backend": ({".open", ".read_text"}, SYSTEM + "; bytes that are compared"),
    "machine.survey": ({".read_text", "json.loads"}, SYSTEM),
    "evaluation.video": ({"cv2.VideoCapture"}, HERE),
    "machine.vulkan": ({"json.loads"}, SYSTEM),
    "perception.capture": ({"json.loads"}, HERE),
    "perception.detectors.open_vocabulary": ({".from_pretrained"}, "transformers reads it, without code and pickles"),
    "perception.detectors.weights": ({"safetensors.torch.load", "torch.load", "zipfile.ZipFile"}, BYTES),
    "perception.exports.coco_folder": ({".open"}, HERE),
    "perception.exports.licences": ({"csv.DictReader"}, BYTES),
    "spec.registry.instructions": ({".open"}, SYSTEM),
    "robots.g1_description": ({"xml.etree.ElementTree.parse"}, OWN),
    "robots.without_visuals": ({".read_text", "xml.etree.ElementTree.parse"}, OWN),
    "scenes.original.models": ({".read_text", "json.loads"}, OWN),
    "scenes.original.reading": ({"json.JSONDecoder"}, BYTES + ", with the hooks of the gate"),
    "sketch.scene_cache": ({".read_bytes"}, OWN),
    "sketch.recording": ({".read_bytes"}, OWN),
    "skills.mitigations.extinguish": ({".open"}, "the nozzle of an extinguisher"),
    "validation.mitigation.jets": ({".open"}, "the nozzle of an extinguisher"),
    "learning.vector.board": ({"numpy.memmap"}, "shared memory of this run's own processes"),
    "cli.web.live": ({"json.loads"}, NETWORK),
    "cli.web.playing.link": ({"json.loads"}, HERE),
    "cli.web.session": ({"json.loads"}, NETWORK),
}


def test_files_of_others_are_read_through_the_gate() -> None:
    found = {name: set(readers(path)) for name, path in modules().items() if not name.startswith(GATE)}
    unknown = {name: calls - KNOWN.get(name, (set(), ""))[0] for name, calls in found.items()}
    assert {name: calls for name, calls in unknown.items() if calls} == {}, "read with hazard_ms/spec/foreign instead"


def test_the_list_names_nothing_that_is_gone() -> None:
    known = modules()
    gone = {name: calls - (set(readers(known[name])) if name in known else set()) for name, (calls, _) in KNOWN.items()}
    assert {name: calls for name, calls in gone.items() if calls} == {}
    assert all(why for _, why in KNOWN.values())


def test_a_new_reader_is_seen(tmp_path: Path) -> None:
    planted = tmp_path / "planted.py"
    planted.write_text(
        "import json, numpy as np, cv2, torch, sqlite3, av, zipfile, pickle, gzip, os, io, h5py, yaml\n"
        "from json import loads as l\nfrom PIL import Image\nfrom safetensors.torch import load_file\n"
        "import pyarrow.parquet as pq\n"
        "from hazard_ms.spec.foreign import files, plain\nfrom hazard_ms.spec.foreign.files import read_text\n"
        "def read(p):\n"
        "    files.read_text(p, 1); read_text(p, 1); plain.read(p, 1)\n"  # through the gate
        "    p.open('w'); open(p, 'ab'); open(p, mode='x'); os.open(p, os.O_WRONLY); np.save(p, 1); json.dumps(p)\n"
        "    p.read_text(); (p / 'a').read_bytes(); p.open(); p.parent.open('r+'); open(p); open(p, 'rb'); io.open(p)\n"
        "    json.load(p); l(p); np.load(p); cv2.imread(p); Image.open(p); torch.load(p); load_file(p); av.open(p)\n"
        "    sqlite3.connect(p); zipfile.ZipFile(p); pickle.loads(p); gzip.open(p); yaml.safe_load(p); os.open(p, 0)\n"
        "    pq.read_table(p); h5py.File(p); h5py.File(p, 'w'); x.y.open(p, 'w+')\n"
    )
    assert sorted(readers(planted)) == sorted(
        [".read_text", ".read_bytes", ".open", ".open", ".open", "open", "open", "io.open", "json.load", "json.loads"]
        + ["numpy.load", "cv2.imread", "PIL.Image.open", "torch.load", "safetensors.torch.load_file", "av.open"]
        + ["sqlite3.connect", "zipfile.ZipFile", "pickle.loads", "gzip.open", "yaml.safe_load", "os.open"]
        + ["pyarrow.parquet.read_table", "h5py.File"]
    )
