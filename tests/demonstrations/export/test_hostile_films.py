"""Films of strangers: only those that the recorder could have made are opened and decoded."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from hazard_ms.demonstrations.export.lerobot_film import samples
from hazard_ms.demonstrations.reading import Demonstration, read_episode
from tests.worlds.recorded import film
from tests.worlds.recordings import stored


@pytest.mark.parametrize("content", [b"#EXTM3U\n#EXTINF:1\n/etc/passwd\n", b"", b"\0" * 4000])
def test_a_film_that_is_none_is_refused(tmp_path: Path, content: bytes) -> None:
    pytest.importorskip("av")
    one = read_episode(stored(tmp_path, 0, film=b"12345"))
    (one.folder / "head.mp4").write_bytes(content)
    with pytest.raises(ValueError, match=r"head\.mp4 must be a film"):
        samples(one.films["head"], 3)
    film(one.folder / "head.mp4", [20, 30, 40], 10)
    assert samples(one.films["head"], 2).shape == (2, 64, 64, 3)


def test_a_film_of_large_pictures_is_not_decoded(tmp_path: Path) -> None:
    av = pytest.importorskip("av")
    one: Demonstration = read_episode(stored(tmp_path, 0, film=b"12345"))
    with av.open(str(one.folder / "head.mp4"), "w") as file:
        stream = file.add_stream("libx264", rate=10)
        stream.width, stream.height, stream.pix_fmt = 2048, 1024, "yuv420p"
        file.mux(stream.encode(av.VideoFrame.from_ndarray(np.zeros((1024, 2048, 3), np.uint8), format="rgb24")))
        file.mux(stream.encode())
    with pytest.raises(ValueError, match="must be h264 of at most 1048576 pixels, got h264, 2048 x 1024"):
        samples(one.films["head"], 1)
