"""The films of a LeRobot dataset: those of many episodes one after the other, without encoding them again."""

from __future__ import annotations

import itertools
from collections.abc import Iterator
from contextlib import contextmanager
from fractions import Fraction
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from hazard_ms.demonstrations.export.lerobot_tables import CHUNK, FILM_SIZE, MB, place

CODEC = "h264"  # of recordings
LARGEST, MOST_PIXELS = 256_000_000, 1024 * 1024  # of a film [bytes], of a picture [-] [ours]
MOST_SAMPLES = 100  # pictures of an episode for statistics [ours]


class Film:
    """Appends the films of episodes to the files of a dataset; `close` finishes the last one."""

    def __init__(self, folder: Path, key: str, rate: int) -> None:
        """Begin the films of the camera `key` in the dataset `folder`, which show `rate` pictures a second."""
        self._folder, self._key, self._rate = folder / "videos" / key, key, rate
        self._number = -1  # of the file that is being written
        self._file: Any = None
        self._size = self._shown = 0  # bytes and pictures in it

    def add(self, path: Path, count: int) -> dict[str, Any]:
        """Append the first `count` pictures of the film `path`. Returns the columns that say where they are.

        Raises ValueError for one with fewer pictures, and for films that cannot follow each other.
        """
        with _opened(path) as (film, stream):
            packets = [packet for packet in film.demux(stream) if packet.size][:count]
            if len(packets) < count or any(packet.pts != packet.dts for packet in packets):
                raise ValueError(f"{path} must hold {count} pictures in order, got {len(packets)}")
            size = sum(packet.size for packet in packets)
            if self._file is None or self._size + size > FILM_SIZE * MB:
                self._begin(stream)
            if stream.codec_context.extradata != self._header:
                raise ValueError(f"{path} must be encoded like the films before it, got another header")
            start = self._shown
            for packet in packets:
                packet.stream, packet.time_base = self._stream, Fraction(1, self._rate)
                packet.pts = packet.dts = self._shown
                packet.duration = 1
                self._file.mux(packet)
                self._shown += 1
            self._size += size
        chunk, number = divmod(self._number, CHUNK)
        return {
            f"videos/{self._key}/chunk_index": chunk,
            f"videos/{self._key}/file_index": number,
            f"videos/{self._key}/from_timestamp": start / self._rate,
            f"videos/{self._key}/to_timestamp": self._shown / self._rate,
        }

    def _begin(self, like: Any) -> None:
        import av

        self.close()
        self._number += 1
        path = self._folder / place(self._number, "mp4")
        path.parent.mkdir(parents=True, exist_ok=True)
        self._file = av.open(str(path), "w")
        self._stream = self._file.add_stream_from_template(like)
        self._stream.time_base = Fraction(1, self._rate)
        self._header, self._size, self._shown = like.codec_context.extradata, 0, 0

    def close(self) -> None:
        """Finish the file that is being written."""
        if self._file is not None:
            self._file.close()
            self._file = None


def samples(path: Path, count: int) -> NDArray[np.uint8]:
    """Some of the first `count` pictures of the film `path`, evenly spaced, [N, H, W, 3].

    Raises ValueError for one that is damaged or too large.
    """
    chosen = set(np.linspace(0, count - 1, min(count, MOST_SAMPLES)).round().astype(int).tolist())
    with _opened(path) as (film, stream):
        shown = enumerate(itertools.islice(film.decode(stream), count))
        return np.stack([picture.to_ndarray(format="rgb24") for number, picture in shown if number in chosen])


def picture_info(shown: NDArray[np.uint8], rate: int) -> dict[str, Any]:
    """The entry of pictures [N, H, W, 3] in info.json."""
    height, width, channels = shown.shape[1:]
    return {
        "dtype": "video",
        "shape": [height, width, channels],
        "names": ["height", "width", "channels"],
        "info": {
            "video.height": height,
            "video.width": width,
            "video.codec": "h264",
            "video.pix_fmt": "yuv420p",
            "video.is_depth_map": False,
            "video.fps": rate,
            "video.channels": channels,
            "has_audio": False,
        },
    }


@contextmanager
def _opened(path: Path) -> Iterator[tuple[Any, Any]]:
    """The film `path`, open, and its pictures. Raises ValueError for films that the recorder does not make."""
    import av

    if (size := path.stat().st_size) > LARGEST:
        raise ValueError(f"{path} must have at most {LARGEST} bytes, got {size}")
    try:
        with av.open(str(path), format="mp4") as film:  # which opens no other file, as playlists would
            stream = film.streams.video[0]
            codec = stream.codec_context
            if codec.name != CODEC or codec.width * codec.height > MOST_PIXELS:
                told = f"{codec.name}, {codec.width} x {codec.height}"
                raise ValueError(f"{path} must be {CODEC} of at most {MOST_PIXELS} pixels, got {told}")
            codec.options = {"max_pixels": str(MOST_PIXELS)}  # also for pictures that are larger than the film says
            yield film, stream
    except (av.FFmpegError, IndexError) as error:
        raise ValueError(f"{path} must be a film of a camera, got {error!s:.200}") from None
