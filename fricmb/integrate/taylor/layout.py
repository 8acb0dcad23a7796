"""Names of places in the arrays of a run (see network)."""

# flat[.]: rows of work
WORK, WORK2, WORK3 = range(3)
# old[.]: polynomials of one contact: watched; shifted to where y = 0, or change of force; force or acceleration before
WATCH, SHIFTED, BEFORE = range(3)
# since[.]: the contact broke away where the step ended
AT_END = 2.0
# since[.] of the second row of a contact in two directions: it has broken away a short time ago
FRESH = 3.0
# since[.] where a run starts: the contact slips, as the run before has left it
GOES_ON = 4.0
# relative round-off of one operation
EPS = 2.3e-16
# groups.landing[.]: how long the way to rest takes (0: none is planned); slip velocity where it begins; what its
# parabola has beside the straight line to rest; relative acceleration without friction; what friction slows it by
LASTS, BEGUN, BENDS, PULL, SLOWS = 0, 1, 3, 5, 7
# behind it: slip velocity, way and direction at the time last asked for; how many numbers that makes
AT, WAY, UNIT, PLAN = 8, 10, 12, 14
