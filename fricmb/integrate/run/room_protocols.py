"""Structs by what is in them: kernels that serve several methods name what they read."""

from __future__ import annotations

from typing import Protocol

from fricmb.integrate.problem import Codes, Floats, Floats2, Ints


class Times(Protocol):
    """``span`` (2,), ends of a run, and ``stops``, breakpoints."""

    @property
    def span(self) -> Floats:
        """Ends of the run."""

    @property
    def stops(self) -> Floats:
        """Breakpoints."""


class Events(Protocol):
    """Space for transitions: ``event`` (n_e, 3) time, contact, kind; ``used`` (2,) numbers of rows and transitions."""

    @property
    def event(self) -> Floats2:
        """Time, contact and kind."""

    @property
    def used(self) -> Ints:
        """Numbers of rows and transitions."""


class Modes(Protocol):
    """``mode`` (n_c,) of the contacts and ``n`` (m,), their directions of slip."""

    @property
    def mode(self) -> Codes:
        """Of each contact."""

    @property
    def n(self) -> Floats:
        """Directions of slip."""


class Laws(Protocol):
    """Laws of contacts: their kind, coefficient at rest and limit of that of slip, and rows ``row[k]:row[k+1]``."""

    @property
    def law(self) -> Codes:
        """Kind of law."""

    @property
    def mu_s(self) -> Floats:
        """Coefficient up to which a contact sticks."""

    @property
    def mu_0(self) -> Floats:
        """Limit of the coefficient of slip at rest."""

    @property
    def lean(self) -> Floats:
        """Centre of what a contact sticks by, over its limit."""

    @property
    def row(self) -> Ints:
        """Where the rows of each contact begin."""


class LawsWithStates(Laws, Protocol):
    """Laws, and where the states of each begin, ``z_start[k]:z_start[k+1]``."""

    @property
    def z_start(self) -> Ints:
        """Where the states of each law begin."""


class Mobility(Protocol):
    """Contacts whose rows ``row[k]:row[k+1]`` accelerate by D F under forces F (m,)."""

    @property
    def row(self) -> Ints:
        """Where the rows of each contact begin."""

    @property
    def D(self) -> Floats2:
        """W^T M^-1 W (m, m)."""


class LawsWithKnots(LawsWithStates, Protocol):
    """Laws whose coefficients bend at the slip speeds ``knots[knot_start[k]:knot_start[k+1]]``."""

    @property
    def knot_start(self) -> Ints:
        """Where the knots of each law begin."""

    @property
    def knots(self) -> Floats:
        """Slip speeds, rising for each law."""


class AtContacts(Protocol):
    """What contacts do at an instant: ``mode``, ``N`` (n_c,), ``n``, ``F``, ``g`` (m,), ``z``, ``zd`` (n_z,)."""

    @property
    def t(self) -> float:
        """Time."""

    @property
    def mode(self) -> Codes:
        """Of each contact."""

    @property
    def n(self) -> Floats:
        """Directions of slip."""

    @property
    def F(self) -> Floats:
        """Friction forces."""

    @property
    def g(self) -> Floats:
        """Slip velocities."""

    @property
    def N(self) -> Floats:
        """Loads."""

    @property
    def z(self) -> Floats:
        """States of laws."""

    @property
    def zd(self) -> Floats:
        """Their rates."""


class AtNodes(Protocol):
    """The same at the s nodes of a step that has been solved: ``F``, ``g`` (s, m), ``N`` (s, n_c), ``z``, ``zd``."""

    @property
    def F(self) -> Floats2:
        """Friction forces."""

    @property
    def g(self) -> Floats2:
        """Slip velocities."""

    @property
    def N(self) -> Floats2:
        """Loads."""

    @property
    def z(self) -> Floats2:
        """States of laws."""

    @property
    def zd(self) -> Floats2:
        """Their rates."""
