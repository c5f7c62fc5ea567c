"""Zip archives of others: few members with plain, different names, no larger than they announce."""

from __future__ import annotations

import io
import stat
import zipfile

from hazard_ms.spec.foreign.arrays import check_archive
from hazard_ms.spec.foreign.files import printable

PACKED = (zipfile.ZIP_STORED, zipfile.ZIP_DEFLATED)
ENCRYPTED = 0x1  # flag of a member (APPNOTE.TXT 4.4.4)


def read_archive(content: bytes, what: str, most: int, members: int) -> dict[str, bytes]:
    """The content of each member of an archive, by name and in its order; nothing is written anywhere.

    Raises ValueError, which calls the archive `what`, for anything but a zip archive of at most `members` regular files
    whose names differ and lead nowhere, and which unpack to at most `most` bytes together.
    """
    check_archive(content, what, most)
    found: dict[str, bytes] = {}
    try:
        with zipfile.ZipFile(io.BytesIO(content)) as archive:
            listed = archive.infolist()
            if len(listed) > members:
                raise ValueError(f"at most {members} members, got {len(listed)}")
            for member in listed:
                _check_member(member, found)
                with archive.open(member) as file:
                    found[member.filename] = file.read()  # never more than it announces; else its checksum is wrong
                if len(found[member.filename]) != member.file_size:
                    raise ValueError(f"members of the size that they declare, got {member.filename!r:.100}")
    except Exception as error:  # zipfile and zlib raise many kinds
        told = str(error) if type(error) is ValueError else f"{type(error).__name__}: {error}"
        raise ValueError(f"{printable(what)} must be an archive with {printable(told)[:300]}") from None
    return found


def _check_member(member: zipfile.ZipInfo, found: dict[str, bytes]) -> None:
    """Raises ValueError for a member that is no regular file, or whose name is odd or taken."""
    name, mode = member.filename, member.external_attr >> 16
    if name in found:
        raise ValueError(f"names that differ, got {name!r:.100} twice")
    odd = not name.isascii() or not name.isprintable() or "\\" in name or ":" in name
    if odd or any(part in ("", ".", "..") for part in name.split("/")):
        raise ValueError(f"plain names that stay inside it, got {name!r:.100}")
    if stat.S_IFMT(mode) not in (0, stat.S_IFREG):
        raise ValueError(f"regular files, got a link or a device: {name!r:.100}")
    if member.compress_type not in PACKED or member.flag_bits & ENCRYPTED:
        raise ValueError(f"members that are stored or deflated and not encrypted, got {name!r:.100}")
