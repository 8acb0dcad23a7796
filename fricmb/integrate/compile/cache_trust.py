"""Whether a file may be run: who owns it and the folders above it, and who can write there.

Kept kernels are unpickled and kept templates executed, so they are believed where only this user, or root, can have
written them.  The rule is that of OpenSSH for keys; Windows is not asked (profiles are private there).
"""

from __future__ import annotations

import os
import stat
from functools import cache
from pathlib import Path

#: A part of messages: how to make a folder one's own.
ADVICE = "`chmod go-w` it, or set FRICMB_CACHE_DIR to a folder of your own"


def fault_of_folder(folder: Path) -> str | None:
    """Why somebody else may have put files into a folder that is there, or is to be made; None: nobody can have.

    Every folder above it counts, as it was named and where links lead: who can write there can put another in its
    place.
    """
    if os.name == "nt":
        return None
    named = Path(os.path.abspath(folder))
    found = Path(os.path.realpath(folder))
    for place in dict.fromkeys([named, found, *named.parents, *found.parents]):
        try:
            held = place.lstat()
        except OSError:  # not made yet, or not to be seen: then nothing in it is read
            continue
        fault = fault_of(held, above=place not in (named, found))
        if fault is not None:
            return f"{place} {fault}"
    return None


def fault_of(held: os.stat_result, *, above: bool = False) -> str | None:
    """What is wrong with the owner or the mode of a file or folder; None: nothing.

    In a folder that is only ``above``, a sticky bit (that of /tmp) keeps others from replacing what is not theirs.
    """
    if os.name == "nt":
        return None
    if held.st_uid not in _trusted():
        return f"belongs to user {held.st_uid}"
    if stat.S_ISLNK(held.st_mode) or (above and held.st_mode & stat.S_ISVTX):
        return None
    if held.st_mode & stat.S_IWOTH:
        return "can be written by everybody"
    if held.st_mode & stat.S_IWGRP and not _is_private(held.st_gid):
        return f"can be written by group {held.st_gid}"
    return None


def _trusted() -> set[int]:
    """Root, this user, and who owns ``/``: in a container without root its files show another number."""
    return {0, os.geteuid(), _owner_of_root()}


@cache
def _owner_of_root() -> int:
    return os.stat("/").st_uid


@cache
def _is_private(group: int) -> bool:
    """Whether a group is that of this user alone, as many systems make one for each user."""
    import grp
    import pwd

    try:
        user, found = pwd.getpwuid(os.geteuid()).pw_name, grp.getgrgid(group)
    except KeyError:
        return False
    return found.gr_name == user and set(found.gr_mem) <= {user}
