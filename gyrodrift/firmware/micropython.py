"""Restlevel for MicroPython: the very source of `gyrodrift.filters.restlevel`, as one module without typing.

Dataclasses become plain classes, and annotations, docstrings and imports between the files go. So both versions are
one source, and no second text can differ from it.
"""

import ast
from pathlib import Path

import gyrodrift.filters

ROOT = Path(gyrodrift.filters.__file__).parent
FILES = (
    "limits",
    "gaps",
    "beliefs",
    "contradictions",
    "restlevel.bias_state",
    "restlevel.rate_state",
    "restlevel.model",
    "restlevel.kalman",
    "restlevel.mixture",
    "restlevel.noise",
    "restlevel.wander",
    "restlevel.durations",
    "restlevel.slide",
    "restlevel.turns",
    "restlevel.vibration",
    "restlevel.segments",
    "restlevel.recall",
    "restlevel.temperature",
    "restlevel.hypotheses",
    "restlevel.gap",
    "restlevel.frozen",
    "restlevel.witness",
    "restlevel.step",
    "restlevel.zero",
)
"""Files in an order in which a file knows only those before it."""

HEAD = '''\
"""Restlevel for MicroPython: yaw, its sigma, and bias of one gyro axis. Written by gyrodrift @VERSION@.

    restlevel = Restlevel()
    restlevel.update_us(time.ticks_us(), rate_dps)    # for each measurement
    print(restlevel.yaw_deg, restlevel.yaw_sigma_deg, restlevel.bias_dps)

The functions are those of gyrodrift/filters/restlevel, which explains them.
"""
'''

TAIL = '''

class Restlevel:
    """The filter. `state` has all results; the most used are attributes."""

    def __init__(self, **params):
        self.coefficients = coefficients(RestlevelParams(**params))
        self.state = RestlevelState()
        self.state.level.clear()  # of a filter of three axes
        self._ticks_us = 0

    def update(self, t_s, rate_dps, still=nan, temp_c=nan):
        """Take a sample at a time in s, for ports with floats of 64 bits; False if it is rejected."""
        return step(self.coefficients, self.state, t_s, rate_dps, still, temp_c)

    def update_us(self, ticks_us, rate_dps, still=nan, temp_c=nan):
        """Take a sample at a time of `time.ticks_us`, which wraps; False if it is rejected."""
        s = self.state
        dt_s = ticks_diff(ticks_us, self._ticks_us) / 1e6 if s.samples > 0 else 0.0
        if s.watch.has_restarted:
            dt_s = max(dt_s, LEAST_STEP_S)
        if not -MOST_DPS <= rate_dps <= MOST_DPS or (s.samples > 0 and dt_s < LEAST_STEP_S):
            s.rejected += 1
            return False
        s.t_s += dt_s
        self._ticks_us = ticks_us
        advance(self.coefficients, s, dt_s, rate_dps, still, temp_c)
        return True

    def zero(self):
        """Restart the yaw sigma at the last sample."""
        zero_yaw(self.state)

    def gap(self):
        """Take the next step as a gap: yaw is held, and its sigma grows."""
        if self.state.samples > 0:
            expect_gap(self.state.watch, UNKNOWN_S, has_restarted=False)

    def restarted(self):
        """Take the next step as a restart of the gyro: its bias is another one, too."""
        if self.state.samples > 0:
            expect_gap(self.state.watch, UNKNOWN_S, has_restarted=True)

    yaw_deg = property(lambda self: self.state.yaw_deg)
    yaw_sigma_deg = property(lambda self: self.state.yaw_sigma_deg)
    bias_dps = property(lambda self: self.state.bias_dps)
    bias_sigma_dps = property(lambda self: self.state.bias_sigma_dps)
    rest_probability = property(lambda self: self.state.rest_probability)
    confidence = property(lambda self: self.state.confidence)
    samples = property(lambda self: self.state.samples)
    rejected = property(lambda self: self.state.rejected)
    correction_deg = property(lambda self: self.state.correction_deg)
    corrections = property(lambda self: self.state.corrections)
'''


def restlevel_py() -> str:
    """Text of the module.

    Raises
    ------
    ValueError
        Two files give a name to different things, which one module cannot hold.
    """
    body, named = list[ast.stmt](), dict[str, str]()
    math: set[str] = {"nan"}
    for name in FILES:
        tree = ast.parse((ROOT / f"{name.replace('.', '/')}.py").read_text(encoding="utf-8"))
        math |= _math_names(tree)
        for statement in filter(None, map(_plain, tree.body)):
            for taken in _names_of(statement):
                if named.setdefault(taken, name) != name:
                    raise ValueError(f"{taken}: both {named[taken]} and {name} define it")
            body.append(statement)
    constants = "nan = float('nan')\n" + ("pi = 3.141592653589793\n" if "pi" in math else "")
    imports = (
        "from collections import namedtuple\n"
        f"from math import {', '.join(sorted(math - {'nan', 'pi'}))}\n"
        "from time import ticks_diff\n\n"
    )
    source = ast.unparse(ast.fix_missing_locations(ast.Module(body, [])))
    return f"{HEAD}\n{imports}{constants}{source}\n{TAIL}"


def _math_names(tree: ast.Module) -> set[str]:
    imports = [node for node in tree.body if isinstance(node, ast.ImportFrom) and node.module == "math"]
    return {alias.name for node in imports for alias in node.names}


def _names_of(statement: ast.stmt) -> list[str]:
    """Names that a statement of a module defines."""
    if isinstance(statement, ast.FunctionDef | ast.ClassDef):
        return [statement.name]
    return [node.id for node in ast.walk(statement) if isinstance(node, ast.Name) and isinstance(node.ctx, ast.Store)]


def _plain(statement: ast.stmt) -> ast.stmt | None:
    """Statement without typing; None for imports and docstrings."""
    match statement:
        case ast.Import() | ast.ImportFrom() | ast.Expr():
            return None
        case ast.ClassDef(bases=[ast.Name(id="NamedTuple")]):
            return _named_tuple(statement)
        case ast.ClassDef():
            return _plain_class(statement)
        case ast.FunctionDef():
            return _plain_function(statement)
    return statement


def _named_tuple(statement: ast.ClassDef) -> ast.stmt:
    names = tuple(field.target.id for field in _fields(statement) if isinstance(field.target, ast.Name))
    return ast.parse(f"{statement.name} = namedtuple({statement.name!r}, {names!r})").body[0]


def _fields(statement: ast.ClassDef) -> list[ast.AnnAssign]:
    return [node for node in statement.body if isinstance(node, ast.AnnAssign)]


def _plain_class(statement: ast.ClassDef) -> ast.ClassDef:
    """Class with a constructor that takes plain fields as keywords; a field with a factory gets a new value."""
    arguments, lines = list[str](), list[str]()
    for field in _fields(statement):
        name, value = ast.unparse(field.target), field.value
        if isinstance(value, ast.Call):
            factory = next(keyword.value for keyword in value.keywords if keyword.arg == "default_factory")
            lines.append(f"self.{name} = {ast.unparse(factory)}()")
        else:
            arguments.append(name if value is None else f"{name}={ast.unparse(value)}")
            lines.append(f"self.{name} = {name}")
    methods = [_plain_function(node) for node in statement.body if isinstance(node, ast.FunctionDef)]
    made = ast.parse(f"def __init__({', '.join(['self', *arguments])}):\n " + "\n ".join(lines)).body[0]
    return ast.ClassDef(name=statement.name, bases=[], keywords=[], body=[made, *methods], decorator_list=[])


def _plain_function(function: ast.FunctionDef) -> ast.FunctionDef:
    """Function without annotations and docstring."""
    for argument in (*function.args.posonlyargs, *function.args.args, *function.args.kwonlyargs):
        argument.annotation = None
    function.returns = None
    body = function.body[1:] if ast.get_docstring(function) is not None else function.body
    function.body = [_plain_assignment(statement) for statement in body] or [ast.Pass()]
    return function


def _plain_assignment(statement: ast.stmt) -> ast.stmt:
    if isinstance(statement, ast.AnnAssign) and statement.value is not None:
        return ast.Assign(targets=[statement.target], value=statement.value)
    return statement
