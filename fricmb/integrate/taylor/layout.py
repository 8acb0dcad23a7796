"""Names of places in the arrays of a run (see _net)."""

# x: time; size of the present step; longest step; tolerance; totals of input and damping; end of the run; speeds
# below NOISE are round-off; next step; the part of the step (s) that
# counts, and that in which friction curves hold; largest speed, or that to which the step begins to lead; the same by
# accelerations alone; when steps that are next to nothing began; step
# that polynomials were made for
TIME, STEP, LONGEST, TOL, INPUT, DAMPING, END, NOISE, NEXT, UNTIL, ALLOWED, FASTEST, REACHED, CREPT, MADE = range(15)
# i: steps, shortened ones, events, samples taken, size of the heap, searches, events in this step and their limit,
# phase of the step, next stop; contacts and groups that a correction touches; steps in a row that did not move the
# time; transitions in a row with which steps began; steps in a row that are next to nothing
N_STEPS, N_SHORTER, N_EVENTS, N_SAMPLES, N_HEAP, N_SEARCHES, N_HERE, LIMIT, PHASE, N_STOP = range(10)
N_TOUCHED, N_GROUPS, STALLED, N_ONCE, N_CREEP = range(10, 15)
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
