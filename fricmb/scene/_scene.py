"""A scene: named parts that belong together."""

from __future__ import annotations

import dataclasses
from collections.abc import Callable, Iterable, Mapping, Sequence
from typing import TYPE_CHECKING, Any, ClassVar, TypeVar

import numpy as np
from numpy.typing import NDArray

from fricmb._calls import answers
from fricmb._facade import facade
from fricmb.errors import SceneError, shown, unknown_name
from fricmb.scene import _parameters
from fricmb.scene._bodies import Body, Driven
from fricmb.scene._check import check_scene
from fricmb.scene._companions import keeps_companions, with_companions, with_guides
from fricmb.scene._contact import Contact
from fricmb.scene._element import Element
from fricmb.scene._family_of import family_of
from fricmb.scene._forms import LinearForm
from fricmb.scene._graph import scene_graph
from fricmb.scene._joint import Joint
from fricmb.scene._matrix import MatrixElement
from fricmb.scene._modal import ModalBody, Point
from fricmb.scene._other_values import numbers_alone, with_changed
from fricmb.scene._part import LETTERS, Part
from fricmb.scene._rigid import PLANE, RigidBody, RigidPoint
from fricmb.scene._space_body import SpaceBody, SpacePoint
from fricmb.values import DIMENSIONS, Units, counted, has_entries, value_of
from fricmb.values._pause import no_collection

if TYPE_CHECKING:
    import networkx
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from fricmb.analysis import NaturalModes
    from fricmb.equations._scene import SceneEquations
    from fricmb.plan import Plan

_Made = TypeVar("_Made")
_Point = TypeVar("_Point", RigidPoint, SpacePoint)

#: Parts with degrees of freedom.
BODIES = (Body, ModalBody, RigidBody, SpaceBody)


class Scene:
    """Bodies, elements and contacts; immutable.

    Parameters
    ----------
    name : str
    parts : iterable of parts
        In the order of the degrees of freedom; every body that a part refers to must be among them.
    units : Units, optional
        Units of the numbers, for labels: ``units=fm.Units("s", "m", "N")``; default: the names of the dimensions.

    Raises
    ------
    SceneError
        If names repeat, a part refers to something that is not there, or parameters of one name have two values.

    Attributes
    ----------
    name : str
    parts : tuple of parts
    dof_names : tuple of str
    units : Units
    """

    __slots__ = ("_by_name", "_cache", "_motions", "_shared", "dof_names", "name", "parts", "units")

    #: Arguments from which a file makes it again.
    _stored: ClassVar[tuple[str, ...]] = ("name", "parts", "units")
    #: Those that older files do not have.
    _stored_later: ClassVar[tuple[str, ...]] = ("units",)

    name: str
    parts: tuple[Part, ...]
    dof_names: tuple[str, ...]
    units: Units
    _by_name: dict[str, Part]
    _motions: dict[str, LinearForm] | None
    #: What other layers keep with this very scene; left out of pickles and comparisons.
    _cache: dict[Any, Any]
    #: The same, shared by all scenes that replace() and with_parameters() made of one another, and by scenes made apart
    #: that look so (``_family_of``).
    _shared: dict[Any, Any]

    @answers
    def __init__(self, name: str, parts: Iterable[Part], *, units: Units = DIMENSIONS) -> None:
        self._fill(name, parts, units, None)

    def _fill(self, name: Any, parts: Any, units: Any, shared: dict[Any, Any] | None) -> None:
        if not isinstance(name, str) or not name:
            raise SceneError(f"Scene: name must be a non-empty string, got {shown(name)}")
        if isinstance(parts, Part | str) or not has_entries(parts):
            raise SceneError(f"Scene {name!r}: parts must be a list of parts, got {shown(parts)}")
        if not isinstance(units, Units):
            raise SceneError(
                f'Scene {name!r}: units must be a Units, such as fm.Units("s", "m", "N"), got {shown(units)}'
            )
        put = object.__setattr__
        put(self, "name", name)
        put(self, "units", units)
        put(self, "parts", with_companions(tuple(parts)))
        put(self, "_by_name", {part.name: part for part in self.parts if isinstance(part, Part)})
        bodies = [part for part in self.parts if isinstance(part, BODIES)]
        put(self, "dof_names", tuple([name for body in bodies for name in body.dof_names]))
        put(self, "_motions", None)
        put(self, "_cache", {})
        put(self, "_shared", {} if shared is None else shared)
        with no_collection(len(self.parts)):
            check_scene(self)
        if shared is None:  # what was found wrong above joins no family
            put(self, "_shared", family_of(name, self.parts))

    def _once(self, key: Any, make: Callable[[], _Made]) -> _Made:
        """What ``make`` makes of this scene; kept with it."""
        if key not in self._cache:
            self._cache[key] = make()
        found: _Made = self._cache[key]
        return found

    def __setattr__(self, name: str, value: Any) -> None:
        raise AttributeError(f"Scene {self.name!r} cannot be changed; use replace() or with_parameters()")

    # -- parts --------------------------------------------------------------------------------------------------
    def __getitem__(self, name: str) -> Part:
        """The part of that name."""
        if not isinstance(name, str) or name not in self._by_name:
            raise unknown_name(f"part of scene {self.name!r}", name, self._by_name)
        return self._by_name[name]

    def __contains__(self, name: object) -> bool:
        return name in self._by_name

    @property
    def bodies(self) -> tuple[Body | ModalBody | RigidBody | SpaceBody, ...]:
        """Parts with degrees of freedom."""
        return tuple([part for part in self.parts if isinstance(part, BODIES)])

    @property
    def driven(self) -> tuple[Driven, ...]:
        """Parts whose motion is prescribed."""
        return self._once("driven", lambda: tuple(part for part in self.parts if isinstance(part, Driven)))

    @property
    def elements(self) -> tuple[Element, ...]:
        """Force elements."""
        return tuple(part for part in self.parts if isinstance(part, Element))

    @property
    def matrices(self) -> tuple[MatrixElement, ...]:
        """Elements given as matrices."""
        return tuple(part for part in self.parts if isinstance(part, MatrixElement))

    @property
    def contacts(self) -> tuple[Contact, ...]:
        """Frictional contacts."""
        return tuple(part for part in self.parts if isinstance(part, Contact))

    @property
    def joints(self) -> tuple[Joint, ...]:
        """Constraints between bodies."""
        return tuple(part for part in self.parts if isinstance(part, Joint))

    @property
    def frictional(self) -> tuple[Contact | Joint, ...]:
        """Contacts, and joints with friction, in the order of the parts."""
        found = (part for part in self.parts if isinstance(part, Contact | Joint))
        return tuple(part for part in found if isinstance(part, Contact) or part.friction is not None)

    @property
    def is_mechanism(self) -> bool:
        """Whether bodies turn or joints tie them, so that kinematics is not linear."""
        turning = RigidBody | SpaceBody | Joint
        return self._once("mechanism", lambda: any(isinstance(part, turning) for part in self.parts))

    @property
    def points(self) -> dict[str, Point]:
        """Points of modal bodies by name ("plate.tip")."""
        modal = (part for part in self.parts if isinstance(part, ModalBody))
        return {f"{body.name}.{point}": body.point(point) for body in modal for point in body.shapes}

    @property
    def rigid_points(self) -> dict[str, RigidPoint]:
        """Points of rigid bodies by name ("crank.tip"): those declared, and those that parts refer to.

        Raises
        ------
        SceneError
            If one name stands for two places.
        """
        declared = ((body, point) for body in self.bodies if isinstance(body, RigidBody) for point in body.points)
        known = (body.point(point) for body, point in declared)
        return dict(self._once("rigid points", lambda: self._with_those_of_ends(RigidPoint, known)))

    @property
    def space_points(self) -> dict[str, SpacePoint]:
        """Points of bodies in space by name: those declared, and those that parts refer to.

        Raises
        ------
        SceneError
            If one name stands for two places.
        """
        spaces = (body for body in self.bodies if isinstance(body, SpaceBody))
        known = (SpacePoint(body, name) for body in spaces for name in body.offsets)
        return dict(self._once("space points", lambda: self._with_those_of_ends(SpacePoint, known)))

    def _with_those_of_ends(self, kind: type[_Point], known: Iterable[_Point]) -> dict[str, _Point]:
        """Points by name, and those of the kind that parts refer to."""
        found = {point.end_name: point for point in known}
        for part in self.parts if self.is_mechanism else ():
            for end in part.ends():
                if isinstance(end, kind) and found.setdefault(end.end_name, end).offset != end.offset:
                    held = found[end.end_name].offset
                    raise SceneError(f"{part._label()}: the point {end.end_name!r} is at {end.offset} and at {held}")
        return found

    # -- motions ------------------------------------------------------------------------------------------------
    @property
    def motion_names(self) -> tuple[str, ...]:
        """Everything that has a motion: dofs, points ("plate.tip.x"), driven bodies along their axes ("belt.x")."""
        return tuple(self._named_motions())

    def _named_motions(self) -> dict[str, LinearForm]:
        motions = self._motions
        if motions is None:
            motions = {name: LinearForm(((name, 1.0),)) for name in self.dof_names}
            for point in self.points.values():
                for c in point.letters:
                    motions[f"{point.end_name}.{c}"] = point.body.modal_form(point.point, c)
            for name in self.rigid_points:
                motions |= {f"{name}.{c}": LinearForm(((f"{name}.{c}", 1.0),)) for c in PLANE}
            for name, fixed in self.space_points.items():
                motions |= {f"{name}.{c}": fixed.motion(c) for c in LETTERS}
            for body in self.driven:
                for c in body.letters or LETTERS:
                    motions[f"{body.name}.{c}"] = body.motion(c)
            object.__setattr__(self, "_motions", motions)
        return motions

    def has_motion(self, name: str) -> bool:
        """Whether the scene has a motion of that name: a dof, a point or a driven body along an axis."""
        return isinstance(name, str) and name in self._named_motions()

    def motion(self, name: str) -> LinearForm:
        """A named motion as a linear form in dofs and prescribed motions (0 for a driven body at rest).

        Raises
        ------
        UnknownNameError
            With the names near it.
        """
        motions = self._named_motions()
        if not isinstance(name, str) or name not in motions:
            raise unknown_name(f"motion in scene {self.name!r}", name, motions)
        return motions[name]

    def dofs_behind(self, name: str) -> tuple[str, ...]:
        """What an expanded motion depends on: of a point of a rigid body all degrees of freedom of the body."""
        owner, _, _ = name.partition(".")
        body = self._by_name.get(owner)
        if isinstance(body, RigidBody) and name not in body.dof_names:
            return body.dof_names
        return (name,)

    def expand(self, form: LinearForm) -> LinearForm:
        """``form`` in dofs and prescribed motions alone: points of modal bodies become sums of modes."""
        motions = self._named_motions()
        for name, _ in form.terms:
            found = motions.get(name)
            if found is None or found.terms != ((name, 1.0),):
                break
        else:
            return form
        result = LinearForm((), form.constant)
        for name, coefficient in form.terms:
            result = result + coefficient * self.motion(name)
        return result

    def initial_values(self, dofs: Sequence[str] | None = None) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Declared initial q and v of the named dofs, (n,) each; default: all."""
        names = self.dof_names if dofs is None else dofs
        if names is self.dof_names or names == self.dof_names:
            return self._all_initial_values()
        place = {name: i for i, name in enumerate(names)}
        values = np.zeros((2, len(names)))
        for name in dict.fromkeys(name.partition(".")[0] for name in names):
            body = self._by_name[name]
            if not isinstance(body, BODIES):
                continue
            for row, argument in zip(values, ("position", "velocity"), strict=True):
                for key, value in body.start_values(argument).items():
                    if (dof := f"{name}.{key}") in place:
                        row[place[dof]] = value_of(value)
        return values[0], values[1]

    def _all_initial_values(self) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        found = self._cache.get("start")
        if found is not None:
            return found[0].copy(), found[1].copy()
        held: tuple[list[float], list[float]] = ([], [])
        for body in self.bodies:
            for row, argument in zip(held, ("position", "velocity"), strict=True):
                values = body.start_values(argument)
                if isinstance(body, Body):
                    row.extend([v if type(v) is float else value_of(v) for v in values.values()])
                else:
                    keys = (name.partition(".")[2] for name in body.dof_names)
                    row.extend([value_of(values.get(key, 0.0)) for key in keys])
        q, v = (np.array(row, dtype=float) for row in held)
        self._cache["start"] = q, v
        return q.copy(), v.copy()

    # -- parameters ---------------------------------------------------------------------------------------------
    @property
    def parameters(self) -> dict[str, Any]:
        """Numbers by name: ``"k1x.stiffness"``, ``"lining.law.mu_k"``; named parameters once, under their own name."""
        return _parameters.collect(self)

    @answers
    def with_parameters(self, values: Mapping[str, Any]) -> Scene:
        """A new scene with other values.

        Parameters
        ----------
        values : dict of str to float
            Keys as in :attr:`parameters`.

        Raises
        ------
        UnknownNameError
            For a name that is no parameter; with the names near it.
        SceneError
            For a value that is not accepted.
        """
        return self._with_parts(_parameters.apply(self, values))

    @answers
    def replace(self, part: str, /, **changes: Any) -> Scene:
        """A new scene in which one part has other fields: ``scene.replace("lining", law=other)``.

        Raises
        ------
        UnknownNameError
            For a part or field that is not there.
        """
        old = self[part]
        known = [f.name for f in dataclasses.fields(old)]
        for field in changes:
            if field not in known:
                raise unknown_name(f"argument of {old._label()}", field, known)
        return self._with_parts({part: dataclasses.replace(old, **changes)})

    def _with_parts(self, changed: dict[str, Part]) -> Scene:
        changed = {name: part for name, part in changed.items() if part is not self._by_name[name]}
        changed = with_guides(self.parts, changed)
        if not changed:
            return self
        parts = with_changed(self, changed)
        scene = object.__new__(type(self))
        stay = all(keeps_companions(self._by_name[name], part) for name, part in changed.items())
        if stay and numbers_alone(self, changed, parts):
            scene._take(self, parts)
        else:
            scene._fill(self.name, parts, self.units, self._shared)
        return scene

    def _take(self, other: Scene, parts: list[Part]) -> None:
        """Be another scene with other numbers in its parts."""
        put = object.__setattr__
        for name in ("name", "units", "dof_names", "_shared"):
            put(self, name, getattr(other, name))
        put(self, "parts", tuple(parts))
        put(self, "_by_name", dict(zip(other._by_name, parts, strict=True)))
        put(self, "_motions", None)
        lasting = {"mechanism": other.is_mechanism, "referring": other._cache.get("referring")}
        put(self, "_cache", lasting)

    @answers
    def with_units(self, units: Units) -> Scene:
        """The same scene with other names for the units of its numbers, which stay as they are."""
        scene = object.__new__(type(self))
        scene._fill(self.name, self.parts, units, self._shared)
        return scene

    # -- facades ------------------------------------------------------------------------------------------------
    @facade
    def modes(self) -> NaturalModes:
        """Natural modes of the structure without friction: frequencies, damping ratios, shapes; printable.

        Springs, matrices, modal bodies and normal-force laws count as they stand at the start; contacts slide freely.
        With friction: :func:`fricmb.analysis.complex_eigenvalues`.

        Raises
        ------
        AnalysisError
            For a scene with joints.
        """

    @facade
    def equations(self, *, joint_coordinates: bool = False) -> SceneEquations:
        """The equations of motion in SymPy: ``.M``, ``.rhs``, ``.latex()``.

        ``joint_coordinates``: bodies that hang on pins, guides and welds in the coordinates of these joints
        (``"pin.angle"``, ``"guide.slide"``), whose reactions drop out; other joints, and those that close loops, stay
        constraints.
        """
    @facade
    def draw(self, *, ax: Axes | None = None) -> Figure:
        """The scene as a matplotlib figure: bodies, springs and dampers along their directions, joints, contacts.

        Rigid bodies are drawn to scale, as they stand at the start; other scenes as a diagram of what is tied to what,
        seen from above where a contact has two tangential directions.  ``ax``: axes to draw into.
        """
    def graph(self) -> networkx.MultiGraph:
        """The scene as a graph of networkx: bodies and the ground are nodes, what acts between them edges.

        Nodes are named by their bodies, the ground is "ground"; ``kind`` is "body", "driven" or "ground".  Edges have
        the name of their part as key; ``kind`` is "element", "contact" or "joint".  ``part`` is the declaration of
        each.  A part that acts on one body alone (a force) is an edge to the ground.  A part that acts on several
        bodies (a matrix), or whose expressions read the motion of others (``reads`` is True there), has an edge from
        the first to each of the others.

        Returns
        -------
        networkx.MultiGraph
            A new one at each call, free to be changed.

        Examples
        --------
        >>> import fricmb as fm
        >>> graph = fm.models.brake4dof().graph()
        >>> sorted(graph)
        ['ground', 'pad', 'rotor']
        >>> sorted(graph["pad"]["rotor"])
        ['lining']
        >>> graph.edges["pad", "rotor", "lining"]["kind"]
        'contact'
        """
        return scene_graph(self)

    @facade
    def plan(self) -> Plan:
        """What will be built and what is left out, with counts; printable."""

    @facade
    def _repr_html_(self) -> str:
        """Show it in a notebook."""

    # -- value --------------------------------------------------------------------------------------------------
    def __eq__(self, other: object) -> bool:
        if not isinstance(other, Scene):
            return NotImplemented
        return self is other or (self.name == other.name and self.parts == other.parts and self.units == other.units)

    def __hash__(self) -> int:
        return hash((self.name, self.parts))

    def __reduce__(self) -> tuple[Any, ...]:
        return _scene, (self.name, self.parts, self.units)

    def __repr__(self) -> str:
        n = len(self.dof_names)
        what = ("coordinate", "") if self.is_mechanism else ("degree of freedom", "degrees of freedom")
        return f"Scene({self.name!r}, {counted(len(self.parts), 'part')}, {counted(n, *what)})"


def _scene(name: str, parts: tuple[Part, ...], units: Units) -> Scene:
    """A scene from what pickles hold."""
    return Scene(name, parts, units=units)
