"""User-defined elements: Python classes with a method for the flow."""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from ctypes import CFUNCTYPE, c_double, c_void_p, cast
from math import inf, nan
from operator import attrgetter
from threading import get_ident
from typing import TYPE_CHECKING, Any, ClassVar, SupportsIndex
from weakref import finalize, ref

from pydantic import WrapSerializer, WrapValidator

from tline.errors import InputError
from tline.scene.element import AtNode, Between, optional
from tline.scene.factor import ALWAYS, Factor
from tline.scene.law import ElementLaw, LawKind, NonLinear
from tline.words.wording import place

if TYPE_CHECKING:
    from tline.scene.scene import Scene

_SIGNATURE = CFUNCTYPE(c_double, c_double, c_double)
_CALLED: dict[int, _Called] = {}  # of each element alive, by its identity: a copy is another element


class UserDefined(LawKind):
    """Law of a user-defined element; constants: effort beyond the element, address of its function."""

    name, unit = "user_defined", "laws.user_defined.user_defined"

    def source(self, c):  # noqa: D102
        return "user-defined; passive if effort times flow is never negative"


class UserElement(NonLinear):
    """Base of `UserLoad` and `UserLink`."""

    kind: ClassVar[str] = "user_defined"
    opening: Factor = optional("what the law is told, from 0 to 1, constant or over time", ALWAYS)

    def flow(self, effort: float, opening: float) -> float:
        """Flow at an effort across the element.

        Parameters
        ----------
        effort : float
            Gauge pressure at the node, Pa, or voltage, V; between nodes that of the first less that of the second,
            of piezometric pressures if the nodes have elevations.
        opening : float
            Value of ``opening`` at that instant.

        Returns
        -------
        float
            m³/s or A. It must not fall where the effort rises; a passive element has effort·flow >= 0.
        """
        raise NotImplementedError

    def __reduce_ex__(self, protocol: SupportsIndex) -> str | tuple[Any, ...]:
        """Pickle the element by the name of its class, for another process."""
        kind = type(self)
        try:
            known = attrgetter(kind.__qualname__)(sys.modules.get(kind.__module__))
        except AttributeError:
            known = None
        if known is not kind:
            expected = "a class that can be imported from a module, for other processes to find it"
            raise InputError(
                "", f"an element of class '{kind.__name__}' cannot be pickled", expected, kind.__qualname__
            )
        return super().__reduce_ex__(protocol)

    def law(self) -> ElementLaw:
        """Law with the method as a C function, which the kernel calls at its address."""
        address = cast(_called(self).function, c_void_p).value or 0
        return ElementLaw("user_defined", (0.0, float(address)), self.opening)  # exact: addresses are below 2**53


class _Called:
    """Method of an element as a C function, and the mistakes in it, by thread."""

    def __init__(self, element: UserElement):
        self.function, self.problems = _SIGNATURE(self._told), {}
        self._element = ref(element)

    def _told(self, effort: float, opening: float) -> float:
        """Flow for the kernel; nan after any mistake, as no exception can pass through it."""
        problem: str | BaseException
        element: Any = self._element()  # alive, for who calls holds its scene
        try:
            flow = float(element.flow(effort, opening))
        except Exception as error:  # noqa: BLE001 - whatever a user's law may raise
            problem = f"({effort:.6g}, {opening:.6g}) raised {type(error).__name__}: {error}"
        except BaseException as error:  # noqa: BLE001 - such as KeyboardInterrupt, raised again when the run has ended
            problem = error
        else:
            if abs(flow) < inf:
                return flow
            problem = f"({effort:.6g}, {opening:.6g}) returned {flow}"
        self.problems.setdefault(get_ident(), problem)
        return nan


def _called(element: UserElement) -> _Called:
    key = id(element)
    if key not in _CALLED:
        _CALLED[key] = _Called(element)
        finalize(element, _CALLED.pop, key, None)
    return _CALLED[key]


class UserLoad(UserElement, AtNode):
    """Load with a law of your own: derive from this class, add fields, and define its flow.

    Examples
    --------
    >>> from tline.scene.user_defined import UserLoad
    >>> from tline.scene.scene import Scene
    >>> from tline.solver.simulate import simulate
    >>> class Clamp(UserLoad):
    ...     limit: float
    ...     def flow(self, effort, opening):
    ...         return max(abs(effort) - self.limit, 0.0) * (0.1 if effort > 0 else -0.1)
    >>> scene = Scene(
    ...     medium="electrical", t_end="20 ns", probes={"far": {"at": "far"}},
    ...     lines={"line": {"nodes": ["near", "far"], "z0": 50, "delay": "5 ns"}},
    ...     sources={"s": {"at": "near", "kind": "voltage", "value": 10, "resistance": 50}},
    ...     loads={"clamp": Clamp(at="far", limit=4.0)},
    ... )
    >>> print(f"{simulate(scene).probes['far'].u[-1]:.6f} V")  # 4 V + 10 ohm · 0.1 A
    5.000000 V
    """


class UserLink(UserElement, Between):
    """Link with a law of your own between two nodes; flow counts positive from the first to the second."""


def user_elements(scene: Scene) -> dict[tuple[str, str], UserElement]:
    """User-defined elements of a scene, by section and name."""
    return {at: element for at, element in scene.placed if isinstance(element, UserElement)}


@contextmanager
def user_mistakes(scene: Scene) -> Iterator[None]:
    """Report mistakes in the laws of user-defined elements during a run, rather than their consequences."""
    found, here = user_elements(scene), get_ident()
    for element in found.values():
        _called(element).problems.pop(here, None)
    try:
        yield
    finally:
        for where, element in found.items():
            problem = _called(element).problems.pop(here, None)
            if isinstance(problem, BaseException):
                raise problem
            if problem:
                told = f"{type(element).__name__}.flow{problem}"
                raise InputError(place(*where), told, "a finite number") from None


def or_user_defined(kind: type[UserElement]) -> tuple[WrapValidator, WrapSerializer]:
    """Pass user-defined elements of that kind unchanged in a union of elements."""

    def itself(value: Any, handler: Callable[[Any], Any]) -> Any:
        return value if isinstance(value, kind) else handler(value)

    def taken(value: Any, handler: Callable[[Any], Any]) -> Any:
        if isinstance(value, UserElement) and not isinstance(value, kind):
            raise InputError("", "does not fit here", f"an {kind.__name__}", f"'{type(value).__name__}'")
        return itself(value, handler)

    return WrapValidator(taken), WrapSerializer(itself)
