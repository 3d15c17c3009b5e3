"""Parameters of the filters as C, from the registry: `parameters.h` of the library, and initializers of its structs.

`python -m gyrodrift.firmware.parameters` writes `files/c/filters/parameters.h` again after a change of the registry.
"""

import textwrap
from collections.abc import Iterator
from dataclasses import fields
from pathlib import Path
from typing import Any, get_type_hints

from annotated_types import Ge, Gt, Le, Lt

from gyrodrift.filters.filter import Filter
from gyrodrift.filters.registry import SHIPPED

FILTERS_FOLDER = Path(__file__).parent / "files" / "c" / "filters"

WIDTH = 120

HEAD = """\
/* Parameters of the filters, their defaults and their bounds. Written by gyrodrift/firmware/parameters.py. */
#ifndef GD_PARAMETERS_H
#define GD_PARAMETERS_H

#include "real.h"
"""


def parameters_h() -> str:
    """Text of `parameters.h`: a struct, defaults and a check of the bounds for each filter of the package."""
    return "\n".join([HEAD, *(_filter_text(kind) for kind in SHIPPED), "#endif\n"])


def initializer(params: Any) -> str:
    """Values of a parameter record as the initializer of its C struct."""
    return "{" + ", ".join(f"GD_R({float(getattr(params, field.name))!r})" for field in fields(params)) + "}"


def bound_checks(params: type[Any]) -> Iterator[str]:
    """C expressions that are true within the bounds, one for each parameter; NaN fulfills none."""
    hints = get_type_hints(params, include_extras=True)
    for field in fields(params):
        yield " && ".join(_check(f"p->{field.name}", bound) for bound in hints[field.name].__metadata__)


def _check(value: str, bound: object) -> str:
    match bound:
        case Ge(ge=limit):
            return f"{value} >= GD_R({limit!r})"
        case Gt(gt=limit):
            return f"{value} > GD_R({limit!r})"
        case Le(le=limit):
            return f"{value} <= GD_R({limit!r})"
        case Lt(lt=limit):
            return f"{value} < GD_R({limit!r})"
    raise TypeError(f"{value}: no check in C for the bound {bound!r}")


def _filter_text(kind: Filter) -> str:
    name = f"gd_{kind.name}_params"
    members = [_member(parameter.name, parameter.line) for parameter in kind.parameters]
    values = initializer(kind.params())
    checks = " &&\n         ".join(bound_checks(kind.params))
    return "\n".join(
        [
            "typedef struct {",
            *members,
            f"}} {name};",
            "",
            f"#define GD_{kind.name.upper()}_DEFAULTS \\\n  {_wrapped(values)}",
            "",
            f"static inline int {name}_are_valid(const {name} *p) {{\n  return {checks};\n}}\n",
        ]
    )


def _member(name: str, meaning: str) -> str:
    return f"  gd_real {name}; /* {meaning} */"


def _wrapped(text: str) -> str:
    return " \\\n   ".join(textwrap.wrap(text, WIDTH - 6, break_long_words=False))


if __name__ == "__main__":
    (FILTERS_FOLDER / "parameters.h").write_text(parameters_h(), encoding="utf-8")
