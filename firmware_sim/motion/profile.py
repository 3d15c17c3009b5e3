"""Profiles by name or path: motions of a turntable, and motions with an attitude.

Profiles are files in `config/profiles/`, those with an attitude in `attitude/` there. A profile starts again when it is
over.
"""

from pathlib import Path

from firmware_sim.motion.attitude.profile import AttitudeProfile
from firmware_sim.motion.turntable import Ambient, Profile, Segment
from firmware_sim.yaml_file import FileError, load, top_keys

__all__ = [
    "Ambient",
    "AttitudeProfile",
    "Profile",
    "Segment",
    "config_folder",
    "load_motion",
    "load_profile",
    "shipped_profiles",
]


def config_folder() -> Path:
    """Folder of rigs and profiles: next to the package in a checkout, inside it in a wheel."""
    installed = Path(__file__).parent.parent / "config"
    return installed if installed.is_dir() else Path(__file__).parent.parent.parent / "config"


def shipped_profiles() -> list[str]:
    """Names of the shipped profiles; those with an attitude come last."""
    return list(_shipped())


def _shipped() -> dict[str, Path]:
    """Files of the shipped profiles by name; those with an attitude are in a folder of their own."""
    folder = config_folder() / "profiles"
    return {path.stem: path for pattern in ("*.yaml", "attitude/*.yaml") for path in sorted(folder.glob(pattern))}


def load_profile(name: str) -> Profile:
    """Profile of a turntable by its path, or by the name of a shipped one.

    Raises
    ------
    FileError
        It does not exist, or has mistakes.
    """
    return load(_path(name), Profile)


def load_motion(name: str) -> Profile | AttitudeProfile:
    """Profile of either sort; a file with the key `motion` has an attitude.

    Raises
    ------
    FileError
        It does not exist, or has mistakes.
    """
    path = _path(name)
    return load(path, AttitudeProfile) if "motion" in top_keys(path) else load(path, Profile)


def _path(name: str) -> Path:
    if Path(name).is_file():
        return Path(name)
    shipped = _shipped()
    if name not in shipped:
        raise FileError(f"{name}: there is no such profile; shipped are {', '.join(shipped)}, or give a file")
    return shipped[name]
