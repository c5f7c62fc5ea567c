"""Writes films: mp4 files that browsers play, opened again and counted before they get their names."""

from __future__ import annotations

import contextlib
import shutil
import subprocess
from fractions import Fraction
from types import TracebackType
from typing import NoReturn

import cv2
import imageio_ffmpeg
import numpy as np
from numpy.typing import NDArray

from hazard_ms.machine.processes import environment
from hazard_ms.spec.storage.files import Draft

FAST = ("-preset", "veryfast", "-crf", "23")  # how ffmpeg encodes films of episodes [ours]
FINE = ("-crf", "20")  # how it encodes few pictures [ours]


class Video:
    """Writes pictures of one size as a film: H.264, yuv420p, index first. A context manager.

    The film is whole when the block ends without an error; an error in the block stops the encoder.
    """

    def __init__(
        self, draft: Draft, size: tuple[int, int], frames_per_second: float, encoding: tuple[str, ...] = FAST
    ) -> None:
        """Start ffmpeg; `size`: width and height [pixels], both even.

        Raises ValueError for a rate that is not positive, an odd size, and an ffmpeg that does not start.
        """
        if frames_per_second <= 0:
            raise ValueError(f"frames_per_second must be positive, got {frames_per_second}")
        if size[0] % 2 or size[1] % 2:
            raise ValueError(f"width and height of a film must be even, got {size[0]} x {size[1]}")
        self.frames = 0
        self._draft, self._size = draft, size
        rate = str(Fraction(frames_per_second).limit_denominator())
        given = ["-f", "rawvideo", "-pix_fmt", "rgb24", "-s", f"{size[0]}x{size[1]}", "-r", rate, "-i", "-"]
        made = ["-an", "-vcodec", "libx264", "-pix_fmt", "yuv420p", *encoding, "-movflags", "+faststart"]
        program = imageio_ffmpeg.get_ffmpeg_exe()
        try:
            self._encoder = subprocess.Popen(
                [program, "-y", "-v", "error", *given, *made, str(draft.path)],
                stdin=subprocess.PIPE,
                stdout=subprocess.DEVNULL,
                env=environment(),
                start_new_session=True,  # Ctrl-C is for this process, which then ends the encoder
            )
        except OSError as error:
            raise ValueError(
                f"ffmpeg must be a program that starts, got {program}: {error.strerror}; IMAGEIO_FFMPEG_EXE names it"
            ) from None

    def add(self, frame: NDArray[np.uint8]) -> None:
        """Append a frame, [H, W, 3], uint8, RGB. Raises ValueError for another shape or type, and if ffmpeg stopped."""
        wide, high = self._size
        if frame.shape != (high, wide, 3) or frame.dtype != np.uint8:
            raise ValueError(f"a frame must be uint8 ({high}, {wide}, 3), got {frame.dtype} {frame.shape}")
        assert self._encoder.stdin is not None
        try:
            self._encoder.stdin.write(np.ascontiguousarray(frame).data)
        except OSError:
            self._refuse("")
        self.frames += 1

    def close(self) -> None:
        """Write the rest and the index, and open the film. Raises ValueError unless it holds every frame."""
        assert self._encoder.stdin is not None
        with contextlib.suppress(OSError):  # an encoder that has stopped: its exit code tells
            self._encoder.stdin.close()
        if self._encoder.wait() != 0:
            self._refuse("")
        found = self._readable()
        if found != self.frames:
            self._refuse(f" and {found} readable pictures of {self.frames}")

    def _readable(self) -> int:
        """Pictures of the right size that another decoder finds in the file."""
        reader, found = cv2.VideoCapture(str(self._draft.path), cv2.CAP_FFMPEG), 0
        try:
            size = tuple(int(reader.get(k)) for k in (cv2.CAP_PROP_FRAME_WIDTH, cv2.CAP_PROP_FRAME_HEIGHT))
            while size == self._size and reader.grab():
                found += 1
        finally:
            reader.release()
        return found

    def _refuse(self, what: str) -> NoReturn:
        """Stop ffmpeg, and say how it failed."""
        self._kill()
        target = self._draft.target
        free = shutil.disk_usage(target.parent).free / 1e6
        raise ValueError(
            f"ffmpeg could not write {target}: it ended with exit code {self._encoder.returncode}{what}; see its "
            f"output above, free some space ({free:.0f} MB are free), or name another ffmpeg in IMAGEIO_FFMPEG_EXE"
        )

    def _kill(self) -> None:
        assert self._encoder.stdin is not None
        with contextlib.suppress(OSError):
            self._encoder.stdin.close()
        if self._encoder.poll() is None:
            with contextlib.suppress(subprocess.TimeoutExpired):
                self._encoder.wait(1.0)  # [s] for its last words [ours]
        self._encoder.kill()
        self._encoder.wait()

    def __enter__(self) -> Video:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        if kind is None:
            self.close()
        else:
            self._kill()
