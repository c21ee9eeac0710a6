"""Compilation of `raytrace.kernels.lanes` to LLVM's vectors.

Importing this module registers types with numba, with their operators and the functions of `lanes`:
eight floats, eight booleans, and eight complex numbers, or rows or matrices of them.
"""

import operator
from collections.abc import Callable, Sequence
from typing import Any

from llvmlite import ir
from numba.core import cgutils, types
from numba.core.imputils import lower_builtin
from numba.core.typing.templates import ConcreteTemplate, infer_global, signature
from numba.extending import models, register_model

from raytrace.kernels import lanes
from raytrace.kernels.lanes import WIDTH

Value = Any
"""A value of LLVM's intermediate language, whose type hints are incomplete."""

_DOUBLE = ir.DoubleType()
_DOUBLES = ir.VectorType(_DOUBLE, WIDTH)
_BITS = ir.VectorType(ir.IntType(1), WIDTH)
_INTS = ir.VectorType(ir.IntType(32), WIDTH)


class LanesType(types.Type):
    """Eight floats."""


class ComplexLanesType(types.Type):
    """Eight complex numbers, real and imaginary parts side by side, or several times as many.

    Parameters
    ----------
    count
        How many times.
    """

    def __init__(self, name: str, count: int) -> None:
        super().__init__(name)
        self.parts = [f"{part}{k}" for k in range(count) for part in ("real", "imag")]


class MaskType(types.Type):
    """Eight booleans."""


LANES, MASK = LanesType("lanes"), MaskType("mask")
COMPLEX = ComplexLanesType("complex_lanes", 1)
ROW, MATRIX = ComplexLanesType("row_lanes", 2), ComplexLanesType("matrix_lanes", 4)
FLOAT, COMPLEX_FLOAT = types.float64, types.complex128


@register_model(LanesType)
class _LanesModel(models.PrimitiveModel):
    def __init__(self, manager: Any, numba_type: types.Type) -> None:
        super().__init__(manager, numba_type, _DOUBLES)


@register_model(MaskType)
class _MaskModel(models.PrimitiveModel):
    def __init__(self, manager: Any, numba_type: types.Type) -> None:
        super().__init__(manager, numba_type, _BITS)


@register_model(ComplexLanesType)
class _ComplexLanesModel(models.StructModel):
    def __init__(self, manager: Any, numba_type: ComplexLanesType) -> None:
        super().__init__(manager, numba_type, [(part, LANES) for part in numba_type.parts])


Lower = Callable[[ir.IRBuilder, Sequence[Any]], Any]
"""Function that emits the instructions, given a builder and the operands: real ones as vectors,
complex ones as real and imaginary parts in turn."""


def _spread(builder: ir.IRBuilder, number: Value) -> Value:
    """Vector of eight equal numbers."""
    one = builder.insert_element(ir.Constant(_DOUBLES, ir.Undefined), number, _index(0))
    zeros = ir.Constant(_INTS, [0] * WIDTH)
    return builder.shuffle_vector(one, ir.Constant(_DOUBLES, ir.Undefined), zeros)


def _index(k: int) -> ir.Constant:
    return ir.Constant(ir.IntType(32), k)


def _operand(context: Any, builder: ir.IRBuilder, kind: types.Type, value: Value) -> Any:
    """Value of a numba type; a number as one vector or several."""
    if kind == FLOAT:
        return _spread(builder, value)
    if kind == COMPLEX_FLOAT:
        number = cgutils.create_struct_proxy(kind)(context, builder, value=value)
        return [_spread(builder, part) for part in (number.real, number.imag)]
    if isinstance(kind, ComplexLanesType):
        made = cgutils.create_struct_proxy(kind)(context, builder, value=value)
        return [getattr(made, part) for part in kind.parts]
    return value


def _implement(
    function: Callable[..., Any], result: types.Type, *cases: tuple[types.Type, ...]
) -> Callable[[Lower], Lower]:
    """Decorate the function that emits the instructions of `function` for these argument types."""

    def decorate(write: Lower) -> Lower:
        def lower(context: Any, builder: ir.IRBuilder, sig: Any, args: Sequence[Value]) -> Any:
            operands = [
                _operand(context, builder, k, v) for k, v in zip(sig.args, args, strict=True)
            ]
            return _returned(context, builder, result, write(builder, operands))

        _register(function, result, cases, lower)
        return write

    return decorate


def _register(
    function: Callable[..., Any],
    result: types.Type,
    cases: Sequence[tuple[types.Type, ...]],
    lower: Callable[..., Value],
) -> None:
    """Register the types of a function and its lowering with numba."""
    for case in cases:
        lower_builtin(function, *case)(lower)
    attributes = {"key": function, "cases": [signature(result, *case) for case in cases]}
    infer: Any = infer_global(function)
    infer(type(f"{function.__name__}_of_lanes", (ConcreteTemplate,), attributes))


def _returned(context: Any, builder: ir.IRBuilder, result: types.Type, value: Any) -> Value:
    """Result of a function as numba represents it."""
    if isinstance(result, ComplexLanesType):
        made = cgutils.create_struct_proxy(result)(context, builder)
        for part, vector in zip(result.parts, value, strict=True):
            setattr(made, part, vector)
        return made._getvalue()
    if isinstance(result, types.UniTuple):
        if result.dtype == COMPLEX:
            value = [_returned(context, builder, COMPLEX, one) for one in value]
        return context.make_tuple(builder, result, value)
    return context.get_dummy_value() if value is None else value


def _with_numbers(own: types.Type, *others: types.Type) -> list[tuple[types.Type, types.Type]]:
    """Types of operands: both of one type, or one of them of another type, on either side."""
    return [(own, own), *((own, o) for o in others), *((o, own) for o in others)]


_REAL_PAIRS = _with_numbers(LANES, FLOAT)
_COMPLEX_TYPES = (COMPLEX, ROW, MATRIX)


def _complex_pairs(own: types.Type) -> list[tuple[types.Type, types.Type]]:
    """Types of operands that are complex: of the same type, or one of them a single number."""
    singles = () if own == COMPLEX else (COMPLEX,)
    return _with_numbers(own, COMPLEX_FLOAT, *singles)


def _mixed_pairs(own: types.Type) -> list[tuple[types.Type, types.Type]]:
    """Types of operands of which the second is real."""
    return [(own, LANES), (own, FLOAT)]


def _implement_operators() -> None:
    """Register arithmetic and comparisons."""
    for name, write in {"add": "fadd", "sub": "fsub", "mul": "fmul", "truediv": "fdiv"}.items():
        for op in (getattr(operator, name), getattr(operator, f"i{name}")):
            _implement(op, LANES, *_REAL_PAIRS)(lambda b, x, w=write: getattr(b, w)(x[0], x[1]))
    for own in _COMPLEX_TYPES:
        _implement_complex_operators(own)
    for name, sign in {"lt": "<", "le": "<=", "gt": ">", "ge": ">=", "eq": "=="}.items():
        _implement(getattr(operator, name), MASK, *_REAL_PAIRS)(
            lambda b, x, s=sign: b.fcmp_ordered(s, x[0], x[1])
        )
    _implement(operator.ne, MASK, *_REAL_PAIRS)(lambda b, x: b.fcmp_unordered("!=", x[0], x[1]))
    for op, write in ((operator.and_, "and_"), (operator.or_, "or_")):
        _implement(op, MASK, (MASK, MASK))(lambda b, x, w=write: getattr(b, w)(x[0], x[1]))
    _implement(operator.invert, MASK, (MASK,))(lambda b, x: b.not_(x[0]))
    _implement(operator.neg, LANES, (LANES,))(lambda b, x: b.fneg(x[0]))


def _implement_complex_operators(own: types.Type) -> None:
    """Register arithmetic of complex numbers, or of several by one."""
    for name, write in {"add": "fadd", "sub": "fsub"}.items():
        for op in (getattr(operator, name), getattr(operator, f"i{name}")):
            _implement(op, own, *_complex_pairs(own))(
                lambda b, x, w=write: [getattr(b, w)(*both) for both in _side_by_side(x)]
            )
    for op in (operator.mul, operator.imul):
        _implement(op, own, *_complex_pairs(own))(_product)
        _implement(op, own, *_mixed_pairs(own))(lambda b, x: [b.fmul(part, x[1]) for part in x[0]])
        _implement(op, own, *((two, one) for one, two in _mixed_pairs(own)))(
            lambda b, x: [b.fmul(x[0], part) for part in x[1]]
        )
    _implement(operator.neg, own, (own,))(lambda b, x: [b.fneg(part) for part in x[0]])


def _side_by_side(x: Sequence[Any]) -> list[tuple[Value, Value]]:
    """Parts of two complex operands; a single number belongs to all of several."""
    count = max(len(operand) for operand in x)
    one, other = (operand * (count // len(operand)) for operand in map(list, x))
    return list(zip(one, other, strict=True))


def _product(builder: ir.IRBuilder, x: Sequence[Any]) -> list[Value]:
    both, found = _side_by_side(x), []
    m, add, subtract = builder.fmul, builder.fadd, builder.fsub
    for (a, c), (b, d) in zip(both[::2], both[1::2], strict=True):
        found += [subtract(m(a, c), m(b, d)), add(m(a, d), m(b, c))]
    return found


_implement_operators()
_implement(lanes.lanes_of, LANES, (FLOAT,))(lambda b, x: x[0])
_implement(lanes.lane, FLOAT, (LANES, types.intp))(lambda b, x: b.extract_element(x[0], x[1]))
_implement(lanes.complex_of, COMPLEX, *_REAL_PAIRS)(lambda b, x: x)
_implement(lanes.real_of, LANES, (COMPLEX,))(lambda b, x: x[0][0])
_implement(lanes.imag_of, LANES, (COMPLEX,))(lambda b, x: x[0][1])
_implement(lanes.where, LANES, *((MASK, *pair) for pair in _REAL_PAIRS))(
    lambda b, x: b.select(x[0], x[1], x[2])
)
for _own in _COMPLEX_TYPES:
    _implement(lanes.where_complex, _own, *((MASK, *pair) for pair in _complex_pairs(_own)))(
        lambda b, x: [b.select(x[0], *both) for both in _side_by_side(x[1:])]
    )
_implement(lanes.row_of, ROW, (COMPLEX, COMPLEX))(lambda b, x: [*x[0], *x[1]])
_implement(lanes.matrix_of, MATRIX, (ROW, ROW))(lambda b, x: [*x[0], *x[1]])
for _own, _count in ((COMPLEX, 1), (MATRIX, 4)):
    _implement(lanes.elements_of, types.UniTuple(COMPLEX, _count), (_own,))(
        lambda b, x: [x[0][k : k + 2] for k in range(0, len(x[0]), 2)]
    )


@_implement(lanes.squared_size, LANES, (COMPLEX,), (MATRIX,))
def _squared_size(builder: ir.IRBuilder, x: Sequence[Any]) -> Value:
    squares = [builder.fmul(part, part) for part in x[0]]
    total = squares[0]
    for square in squares[1:]:
        total = builder.fadd(total, square)
    return total


def _intrinsic(function: Callable[..., Any], name: str, *cases: tuple[types.Type, ...]) -> None:
    """Compile a function to LLVM's intrinsic of that name."""

    def write(builder: ir.IRBuilder, x: Sequence[Any]) -> Value:
        kind = ir.FunctionType(_DOUBLES, [_DOUBLES] * len(x))
        called = cgutils.get_or_insert_function(builder.module, kind, f"llvm.{name}.v{WIDTH}f64")
        return builder.call(called, x)

    _implement(function, LANES, *cases)(write)


_intrinsic(lanes.sqrt, "sqrt", (LANES,))
_intrinsic(lanes.floor, "floor", (LANES,))
_intrinsic(lanes.absolute, "fabs", (LANES,))
_intrinsic(lanes.copysign, "copysign", *_REAL_PAIRS)
_implement(lanes.minimum, LANES, *_REAL_PAIRS)(
    lambda b, x: b.select(b.fcmp_ordered("<", x[0], x[1]), x[0], x[1])
)
_implement(lanes.maximum, LANES, *_REAL_PAIRS)(
    lambda b, x: b.select(b.fcmp_ordered(">", x[0], x[1]), x[0], x[1])
)


_implement(lanes.all_false, MASK, ())(lambda b, x: ir.Constant(_BITS, [0] * WIDTH))


def _as_byte(builder: ir.IRBuilder, mask: Value) -> Value:
    return builder.bitcast(mask, ir.IntType(WIDTH))


@_implement(lanes.any_of, types.boolean, (MASK,))
def _any(builder: ir.IRBuilder, x: Sequence[Any]) -> Value:
    return builder.icmp_unsigned("!=", _as_byte(builder, x[0]), ir.Constant(ir.IntType(WIDTH), 0))


@_implement(lanes.all_of, types.boolean, (MASK,))
def _all(builder: ir.IRBuilder, x: Sequence[Any]) -> Value:
    return builder.icmp_unsigned("==", _as_byte(builder, x[0]), ir.Constant(ir.IntType(WIDTH), -1))


def _implement_on_array(
    function: Callable[..., Any],
    result: types.Type,
    dimensions: int,
    write: Callable[[ir.IRBuilder, Value, Sequence[Value]], Any],
) -> None:
    """Register a function whose first argument is an array, passed on as a pointer."""
    with_lanes = (LANES,) if function is not lanes.load else ()
    cases = [(types.Array(FLOAT, dimensions, "C", readonly=r), *with_lanes) for r in (False, True)]

    def lower(context: Any, builder: ir.IRBuilder, sig: Any, args: Sequence[Value]) -> Any:
        array = context.make_array(sig.args[0])(context, builder, value=args[0])
        return _returned(context, builder, result, write(builder, array.data, args[1:]))

    _register(function, result, cases, lower)


def _load(builder: ir.IRBuilder, data: Value, args: Sequence[Value]) -> Value:
    return builder.load(builder.bitcast(data, _DOUBLES.as_pointer()), align=8)


def _store(builder: ir.IRBuilder, data: Value, args: Sequence[Value]) -> None:
    builder.store(args[0], builder.bitcast(data, _DOUBLES.as_pointer()), align=8)


def _gather(columns: int, stride: int) -> Callable[..., list[Value]]:
    """Return a function that emits loads from `columns` columns of eight rows, transposed."""

    def write(builder: ir.IRBuilder, data: Value, args: Sequence[Value]) -> list[Value]:
        row = ir.VectorType(_DOUBLE, columns)
        rows = builder.fptosi(args[0], _INTS)
        loaded: list[Value] = []
        for k in range(WIDTH):
            at = builder.sext(builder.extract_element(rows, _index(k)), ir.IntType(64))
            at = builder.mul(at, ir.Constant(ir.IntType(64), stride))
            place = builder.bitcast(builder.gep(data, [at]), row.as_pointer())
            loaded.append(builder.load(place, align=8))
        return _transposed(builder, loaded)

    return write


def _transposed(builder: ir.IRBuilder, rows: Sequence[Value]) -> list[Value]:
    """Vectors of the first, second, ... numbers of eight rows of 2, 4 or 8."""
    if rows[0].type.count == 2:
        even, odd = (_joined(builder, [rows[k] for k in (s, s + 2, s + 4, s + 6)]) for s in (0, 1))
        return _unpacked(builder, even, odd)
    if rows[0].type.count == 4:
        one = [_joined(builder, [rows[k], rows[k + 2]]) for k in (0, 1, 4, 5)]
        low = _unpacked(builder, one[0], one[1])
        high = _unpacked(builder, one[2], one[3])
        halves = [_quartered(builder, low[k], high[k]) for k in range(2)]
        return [halves[0][0], halves[1][0], halves[0][1], halves[1][1]]
    twos = [_unpacked(builder, rows[k], rows[k + 1]) for k in (0, 2, 4, 6)]
    result: list[Any] = [None] * 8
    for odd in range(2):
        low = _quartered(builder, twos[0][odd], twos[1][odd])
        high = _quartered(builder, twos[2][odd], twos[3][odd])
        for part in range(2):
            result[2 * part + odd], result[2 * part + odd + 4] = _quartered(
                builder, low[part], high[part]
            )
    return result


def _shuffled(builder: ir.IRBuilder, a: Value, b: Value, take: Sequence[int]) -> Value:
    mask = ir.Constant(ir.VectorType(ir.IntType(32), len(take)), list(take))
    return builder.shuffle_vector(a, b, mask)


def _joined(builder: ir.IRBuilder, parts: Sequence[Value]) -> Value:
    """Concatenation of short vectors."""
    while len(parts) > 1:
        n = parts[0].type.count
        parts = [
            _shuffled(builder, a, b, range(2 * n))
            for a, b in zip(parts[::2], parts[1::2], strict=True)
        ]
    return parts[0]


def _unpacked(builder: ir.IRBuilder, a: Value, b: Value) -> list[Value]:
    """Two vectors interleaved: their even entries, and their odd entries."""
    return [
        _shuffled(builder, a, b, [x for k in range(odd, 8, 2) for x in (k, k + 8)])
        for odd in range(2)
    ]


def _quartered(builder: ir.IRBuilder, a: Value, b: Value) -> list[Value]:
    """First and third pairs of two vectors, and the second and fourth ones."""
    return [
        _shuffled(builder, a, b, [o + k for o in (0, 4, 8, 12) for k in (2 * s, 2 * s + 1)])
        for s in range(2)
    ]


_implement_on_array(lanes.load, LANES, 1, _load)
_implement_on_array(lanes.store, types.none, 1, _store)
_implement_on_array(lanes.gather2, types.UniTuple(LANES, 2), 2, _gather(2, 2))
_implement_on_array(lanes.gather_pairs1, types.UniTuple(LANES, 2), 1, _gather(2, 1))
_implement_on_array(lanes.gather_pairs2, types.UniTuple(LANES, 4), 2, _gather(4, 2))
_implement_on_array(lanes.gather_pairs4, types.UniTuple(LANES, 8), 2, _gather(8, 4))
