"""Blocks of a config that pydantic checks."""

from pydantic import BaseModel, ConfigDict


class Strict(BaseModel):
    """A block of keys: no other keys, no other types, finite numbers."""

    model_config = ConfigDict(extra="forbid", strict=True, allow_inf_nan=False)
