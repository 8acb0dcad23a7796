"""One name for each signal of a run: in ``sol[...]``, tables, fits, sections, spectra and pictures."""

from __future__ import annotations

from typing import Any

import numpy as np

from fricmb._facade import facade
from fricmb.errors import FricmbError, SceneError, UnknownNameError, unknown_name
from fricmb.integrate.problem import Floats
from fricmb.solution._contact_signals import ContactSignals
from fricmb.solution._differentiated import Differentiated

#: What stands behind the name of a motion; of a contact; of an element or a joint.
OF_MOTIONS = ("velocity", "acceleration")
OF_CONTACTS = ("force", "relative_velocity", "normal_force", "mode", "state")
OF_PARTS = ("force", "elongation", "reaction")
_QUANTITIES = frozenset((*OF_MOTIONS, *OF_CONTACTS, *OF_PARTS))


def owner_of(name: str) -> str | None:
    """What a signal belongs to: "mass.x" of "mass.x.velocity", "sole" of "sole.force.x"; None for a motion's name."""
    words = name.split(".")
    places = [i for i, word in enumerate(words) if i > 0 and word in _QUANTITIES]
    return ".".join(words[: places[-1]]) if places else None


class Signals(ContactSignals, Differentiated):
    """Signals by name."""

    def __getitem__(self, name: str) -> Floats:
        """A signal (n_t,) by its name.

        ======================================  ===============================================================
        "mass.x", "plate.tip.x", "belt.x"       position of a degree of freedom, a point, a driven body
        "mass.x.velocity", ".acceleration"      its rates
        "sole.force", "sole.force.x"            friction force on the contact's first end; with two directions
                                                the first is (2, n_t)
        "sole.relative_velocity", "....x"       slip velocity, alike
        "sole.normal_force", "sole.mode"        normal force; 0 stick, 1 slip, 2 open
        "sole.state", "sole.state.z"            states of the law
        "spring.force", "spring.force.x"        force of an element on its first end; with components (k, n_t)
        "spring.elongation"                     what its force follows from, alike
        "pin.reaction"                          reaction of a joint (rows, n_t)
        "rod.rotation", "rod.omega"             of bodies in space (3, 3, n_t), (3, n_t); "axle.axis" (3, n_t)
        ======================================  ===============================================================

        Accelerations are those of the equations of motion at the times of the solution, with the forces of the run.

        Raises
        ------
        UnknownNameError
            For a name that is none; lists those near.
        """
        if not isinstance(name, str):
            raise unknown_name("signal", name, self._near(""))
        names = self.names
        if name in names.dof_index or name in names.motions or name in names.vectors or name in names.signals:
            return self._motion(name, 0)
        found = self._quantity(name)
        if found is None:
            raise self._unknown(name)
        return found

    def scalar(self, name: str, who: str = "signal") -> Floats:
        """A signal (n_t,); SceneError for one of several components, which it names."""
        found = self[name]
        if found.ndim != 1:
            parts = [known for known in self._near(name) if known.startswith(f"{name}.")]
            listed = ", ".join(map(repr, parts))
            raise SceneError(f"{who}: {name!r} has {found.shape[0]} components; expected one of them: {listed}")
        return found

    def signal_names(self) -> list[str]:
        """Names of all signals that are (n_t,) each; what belongs to one contact, element or motion stands together."""
        found = []
        for owner in (*self.names.dofs, *self.names.motions, *self.names.signals):
            found += self._of_motion(owner)
        for contact in self.names.contacts:
            found += self._of_contact(contact)
        for element, axes in self._known_elements().items():
            found += self._of_element(element, axes)
        return found

    def components(self, name: str) -> tuple[str, ...]:
        """Names of the components of a signal of a contact or an element: ("x", "y")."""
        owner = owner_of(name) or name
        if owner in self.names.contact_index:
            return self.names.directions[self.names.contact(owner)]
        axes = self._element_axes().get(owner)
        if axes is None:
            raise self._unknown(name)
        return axes

    @facade
    def _from_scene(self, quantity: str, owner: str) -> Floats:
        """What the scene states and the run does not hold: "acceleration" of motions, others of elements."""

    @facade
    def _element_axes(self) -> dict[str, tuple[str, ...]]:
        """Names of the components of the force of each element."""

    # -- what a name stands for ---------------------------------------------------------------------------------
    def _quantity(self, name: str) -> Floats | None:
        owner = owner_of(name)
        if owner is None:
            return None
        quantity, *rest = name[len(owner) + 1 :].split(".")
        component = ".".join(rest)
        if owner in self.names.contact_index:
            return self._contact_signal(owner, quantity, component)
        if quantity in OF_MOTIONS and not component and self._moves(owner):
            return self._motion(owner, 1) if quantity == "velocity" else self._acceleration(owner)
        if quantity in ("force", "elongation"):
            axes = self._element_axes().get(owner)
            return None if axes is None else _component(self._from_scene(quantity, owner), axes, component)
        if quantity == "reaction" and not component:
            return self.reaction(owner)
        return None

    def _moves(self, owner: str) -> bool:
        names = self.names
        return owner in names.dof_index or owner in names.motions or owner in names.signals or owner in names.vectors

    def _contact_signal(self, contact: str, quantity: str, component: str) -> Floats | None:
        if quantity in ("normal_force", "mode"):
            whole: Any = self.normal_force(contact) if quantity == "normal_force" else self.mode(contact)
            return None if component else whole
        k = self.names.contact(contact)
        if quantity == "state":
            return _component(self.state(contact), self.names.states[k], component)
        if quantity not in ("force", "relative_velocity"):
            return None
        values = self.force(contact) if quantity == "force" else self.relative_velocity(contact)
        return _component(values, self.names.directions[k], component)

    def _acceleration(self, name: str) -> Floats:
        names = self.names
        if name in names.signals:
            return self._from_scene("acceleration", name)
        if name in names.vectors:
            raise SceneError(f"acceleration: {name!r} is no coordinate whose rates are kept")
        if name in names.dof_index:
            found: Floats = self._accelerations[names.dof_index[name]]
            return found
        return names.motions[name].acceleration(self.q, self.v, self._accelerations)

    @property
    def _accelerations(self) -> Floats:
        """Of all degrees of freedom (n, n_t), found once."""
        if "_found_accelerations" not in self.__dict__:
            self.__dict__["_found_accelerations"] = self._from_scene("acceleration", "")
        found: Floats = self.__dict__["_found_accelerations"]
        return found

    # -- what there is ------------------------------------------------------------------------------------------
    def _of_motion(self, name: str) -> list[str]:
        return [name, *(f"{name}.{quantity}" for quantity in OF_MOTIONS)]

    def _of_contact(self, contact: str) -> list[str]:
        k = self.names.contact(contact)
        axes, states = self.names.directions[k], self.names.states[k]
        found = [*_components(f"{contact}.force", axes), *_components(f"{contact}.relative_velocity", axes)]
        found += [f"{contact}.normal_force", f"{contact}.mode"]
        return found + (_components(f"{contact}.state", states) if states else [])

    @staticmethod
    def _of_element(element: str, axes: tuple[str, ...]) -> list[str]:
        return [*_components(f"{element}.force", axes), *_components(f"{element}.elongation", axes)]

    def _known_elements(self) -> dict[str, tuple[str, ...]]:
        """Elements with a force; none where the scene of a file cannot be opened."""
        try:
            return self._element_axes()
        except FricmbError:
            return {}

    def _near(self, name: str) -> list[str]:
        """Names that might be meant: those of the owner, if it is known, else all."""
        head = name.partition(".")[0]
        if head in self.names.contact_index:
            return self._of_contact(head)
        elements = self._known_elements()
        if head in elements:
            return self._of_element(head, elements[head])
        motions = [x for x in self.names.known_motions() if x == name or name.startswith(f"{x}.")]
        return self._of_motion(motions[0]) if motions else self.signal_names()

    def _unknown(self, name: str) -> UnknownNameError:
        return unknown_name("signal", name, self._near(name))


def _components(name: str, axes: tuple[str, ...]) -> list[str]:
    """A signal of one component with and without its axis, of several each of them."""
    several = [f"{name}.{axis}" for axis in axes]
    return [name, *several] if len(axes) == 1 else several


def _component(values: Floats, axes: tuple[str, ...], component: str) -> Floats | None:
    """One component (n_t,), or all of them, of which one alone is (n_t,), too; None for a component that is none."""
    if component:
        return np.asarray(values[axes.index(component)]) if component in axes else None
    return np.asarray(values[0]) if len(axes) == 1 else values
