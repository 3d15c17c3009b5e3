"""Plain Python and its compiled twin: records within records are laid out and changed alike."""

from dataclasses import asdict, dataclass, field

from gyrodrift.evaluation.kernels.compiled import array_of, compiled, layout


@dataclass(slots=True)
class Inner:
    height: float = 1.0
    is_new: bool = True


@dataclass(slots=True)
class Place:
    weight: float = 0.0
    inner: Inner = field(default_factory=Inner)


@dataclass(slots=True)
class Outer:
    count: int = 7
    inner: Inner = field(default_factory=Inner)
    places: list[Place] = field(default_factory=lambda: [Place(), Place(2.0), Place()])


def raised(inner: Inner, by: float) -> float:
    """Changes a record within a record."""
    inner.height += by
    inner.is_new = False
    return inner.height


def changed(outer: Outer, by: float) -> float:
    """Changes what is nested in it, by itself and by a function that it calls."""
    found = raised(outer.inner, by)
    for place in outer.places:
        if place.weight > 1.0:
            found += raised(place.inner, 10.0 * by)
        place.weight += 1.0
    outer.count += 1
    return found


def test_a_layout_has_the_fields_of_the_record() -> None:
    """A record within is a structured type; a list has as many places as a new record."""
    made = layout(Outer)
    assert made.names == ("count", "inner", "places")
    assert made["inner"] == layout(Inner)
    assert made["places"].subdtype == (layout(Place), (3,))


def test_a_compiled_function_changes_nested_records_as_the_plain_one_does() -> None:
    """And gives back the same."""
    plain = Outer()
    made = array_of(plain)
    assert compiled(changed)(made[0], 0.1) == changed(plain, 0.1)
    assert made.tobytes() == array_of(plain).tobytes()
    assert asdict(plain.places[1]) == {"weight": 3.0, "inner": {"height": 2.0, "is_new": False}}
