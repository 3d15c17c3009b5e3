"""Vectors in compiled functions: an operation works on all lanes, with the bits of the scalar operation.

LLVM does not vectorize the recursion by itself, since it cannot know that the step table and the state do not overlap.
These types make the vectors explicit. LLVM splits a vector that is wider than the registers of the processor. The cache
of numba does not see a change of this file: after a change, touch the files that import it.
"""

# mypy: disable-error-code="no-untyped-call, untyped-decorator"
# numba has no types for extensions.

import operator
from collections.abc import Callable
from typing import Any

from llvmlite import ir  # type: ignore[import-untyped]  # ships no type information
from numba import types
from numba.core import cgutils
from numba.extending import intrinsic, lower_builtin, models, register_model, type_callable

ELEMENTS: dict[Any, Any] = {types.float64: ir.DoubleType(), types.int64: ir.IntType(64), types.boolean: ir.IntType(1)}


_operation: Callable[[Callable[..., Any]], Callable[..., Any]] = intrinsic(prefer_literal=True)


class SimdVector(types.Type):
    """The type of `count` values of one element: float64, int64 or boolean."""

    def __init__(self, element: Any, count: int) -> None:
        self.element, self.count = element, count
        super().__init__(name=f"SimdVector({element}, {count})")

    def of(self, element: Any) -> "SimdVector":
        """Type of a vector of the same length with another element."""
        return SimdVector(element, self.count)


@register_model(SimdVector)
class _SimdModel(models.PrimitiveModel):
    def __init__(self, data_models: Any, kind: SimdVector) -> None:
        vector = ir.VectorType(ELEMENTS[kind.element], kind.count)
        super().__init__(data_models, kind, vector)


def _offer(operation: Any, floats: str, integers: str) -> None:
    """Define an arithmetic operation between vectors of one type, by the names of the LLVM instructions."""

    @type_callable(operation)
    def typer(_context: Any) -> Callable[[Any, Any], Any]:
        return lambda a, b: a if isinstance(a, SimdVector) and a == b else None

    @lower_builtin(operation, SimdVector, SimdVector)
    def emit(_context: Any, builder: Any, signature: Any, values: Any) -> Any:
        name = floats if signature.return_type.element == types.float64 else integers
        return getattr(builder, name)(*values)


def _offer_comparison(operation: Any, symbol: str) -> None:
    """Define a comparison between vectors; it is false for NaN."""

    @type_callable(operation)
    def typer(_context: Any) -> Callable[[Any, Any], Any]:
        return lambda a, b: a.of(types.boolean) if isinstance(a, SimdVector) and a == b else None

    @lower_builtin(operation, SimdVector, SimdVector)
    def emit(_context: Any, builder: Any, signature: Any, values: Any) -> Any:
        is_float = signature.args[0].element == types.float64
        return (builder.fcmp_ordered if is_float else builder.icmp_signed)(symbol, *values)


_offer(operator.add, "fadd", "add")
_offer(operator.sub, "fsub", "sub")
_offer(operator.mul, "fmul", "mul")
_offer(operator.truediv, "fdiv", "sdiv")
_offer(operator.and_, "", "and_")
_offer_comparison(operator.lt, "<")
_offer_comparison(operator.gt, ">")
_offer_comparison(operator.eq, "==")


@_operation
def splat(_typing: Any, value: Any, count: Any) -> Any:
    """Vector with the same number in all lanes; `count` is a constant."""
    kind = SimdVector(types.unliteral(value), count.literal_value)

    def emit(_context: Any, builder: Any, _signature: Any, values: Any) -> Any:
        undefined = ir.VectorType(values[0].type, kind.count)(ir.Undefined)
        first = builder.insert_element(undefined, values[0], _lane_index(0))
        return builder.shuffle_vector(first, undefined, ir.VectorType(ir.IntType(32), kind.count)([0] * kind.count))

    return kind(value, count), emit


@_operation
def load(_typing: Any, row: Any, count: Any) -> Any:
    """Load a vector from the first values of a contiguous array."""
    kind = SimdVector(row.dtype, count.literal_value)

    def emit(context: Any, builder: Any, _signature: Any, values: Any) -> Any:
        pointer = _data(context, builder, row, values[0])
        return builder.load(builder.bitcast(pointer, context.get_value_type(kind).as_pointer()), align=8)

    return kind(row, count), emit


@_operation
def store(_typing: Any, row: Any, kind: Any) -> Any:
    """Store a vector in the first values of a contiguous array."""

    def emit(context: Any, builder: Any, _signature: Any, values: Any) -> Any:
        pointer = _data(context, builder, row, values[0])
        builder.store(values[1], builder.bitcast(pointer, values[1].type.as_pointer()), align=8)
        return context.get_dummy_value()

    return types.void(row, kind), emit


@_operation
def look_up(_typing: Any, table: Any, columns: Any) -> Any:
    """Value of row k of a contiguous table at the column in lane k; the column must exist."""
    kind = columns.of(table.dtype)

    def emit(context: Any, builder: Any, _signature: Any, values: Any) -> Any:
        width = cgutils.unpack_tuple(builder, context.make_array(table)(context, builder, values[0]).shape)[1]
        row, vector = _data(context, builder, table, values[0]), context.get_value_type(kind)(ir.Undefined)
        for k in range(kind.count):
            pointer = builder.gep(row, [builder.extract_element(values[1], _lane_index(k))])
            vector = builder.insert_element(vector, builder.load(pointer), _lane_index(k))
            row = builder.gep(row, [width])
        return vector

    return kind(table, columns), emit


@_operation
def select(_typing: Any, mask: Any, a: Any, b: Any) -> Any:
    """`a` where the mask is true, `b` elsewhere."""
    return a(mask, a, b), lambda _context, builder, _signature, values: builder.select(*values)


@_operation
def magnitude(_typing: Any, a: Any) -> Any:
    """Absolute values of floats."""
    return a(a), _named(f"llvm.fabs.v{a.count}f64")


@_operation
def with_sign(_typing: Any, a: Any, b: Any) -> Any:
    """Magnitude of `a` with the sign of `b`, floats; the sign of a zero counts."""
    return a(a, b), _named(f"llvm.copysign.v{a.count}f64")


@_operation
def signs(_typing: Any, a: Any) -> Any:
    """−1, 0 or 1, the sign of floats, as int64; 0 for NaN."""
    kind = a.of(types.int64)

    def emit(context: Any, builder: Any, _signature: Any, values: Any) -> Any:
        zeros, whole = values[0].type([0.0] * a.count), context.get_value_type(kind)
        below, above = (builder.fcmp_ordered(symbol, values[0], zeros) for symbol in "<>")
        return builder.sub(builder.sext(below, whole), builder.sext(above, whole))

    return kind(a), emit


@_operation
def is_any(_typing: Any, mask: Any) -> Any:
    """Whether the mask is true in some lane."""

    def emit(_context: Any, builder: Any, _signature: Any, values: Any) -> Any:
        bits = ir.IntType(mask.count)
        return builder.icmp_unsigned("!=", builder.bitcast(values[0], bits), bits(0))

    return types.boolean(mask), emit


def _lane_index(lane: int) -> Any:
    return ir.IntType(32)(lane)


def _data(context: Any, builder: Any, array: Any, value: Any) -> Any:
    """Pointer to the values of an array."""
    return context.make_array(array)(context, builder, value).data


def _named(name: str) -> Callable[[Any, Any, Any, Any], Any]:
    """A function of LLVM between vectors of one type."""

    def emit(_context: Any, builder: Any, _signature: Any, values: Any) -> Any:
        kind = ir.FunctionType(values[0].type, [value.type for value in values])
        return builder.call(cgutils.get_or_insert_function(builder.module, kind, name), values)

    return emit
