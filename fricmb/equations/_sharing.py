"""What products have in common, computed once: two factors that several products hold become one factor."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterable, Sequence
from heapq import heapify, heappop, heappush
from itertools import combinations

#: A node and its exponent.
Factor = tuple[int, float]


class Sharing:
    """Products as sets of factors, known by their place; those of two others come behind those that were given.

    Attributes
    ----------
    given : list of Factor
    pairs : list of (int, int)
        Places of the two factors that make one.
    rows : list of set of int
        Of each product the places of its factors.
    """

    def __init__(self, products: Iterable[Sequence[Factor]]) -> None:
        places: dict[Factor, int] = {}
        self.rows = [{places.setdefault(factor, len(places)) for factor in product} for product in products]
        self.given, self.pairs = list(places), list[tuple[int, int]]()
        self._holders: dict[tuple[int, int], set[int]] = defaultdict(set)
        for number, row in enumerate(self.rows):
            for pair in combinations(sorted(row), 2):
                self._holders[pair].add(number)
        self._join_most_common()

    def _join_most_common(self) -> None:
        """Join the pair that most products hold, over and over again."""
        heap = [(-len(held), pair) for pair, held in self._holders.items() if len(held) > 1]
        heapify(heap)
        while heap:
            count, pair = heappop(heap)
            now = len(self._holders[pair])
            if now < -count:  # some of its products hold it no more
                if now > 1:
                    heappush(heap, (-now, pair))
                continue
            for other in self._join(pair):
                if len(self._holders[other]) > 1:
                    heappush(heap, (-len(self._holders[other]), other))

    def _join(self, pair: tuple[int, int]) -> list[tuple[int, int]]:
        """Make one factor of two wherever they occur together; the pairs that it is in."""
        new = len(self.given) + len(self.pairs)
        self.pairs.append(pair)
        beside: set[int] = set()
        for number in self._holders.pop(pair):
            row = self.rows[number]
            row -= set(pair)
            for other in row:
                for part in pair:
                    self._holders[min(other, part), max(other, part)].discard(number)
                self._holders[other, new].add(number)
            beside |= row
            row.add(new)
        return [(other, new) for other in sorted(beside)]
