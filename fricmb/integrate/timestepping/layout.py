"""Names of places in the arrays of a run (see room)."""

# what Run.fault says: nothing; the coefficient is negative; a coefficient or normal force is no number
SOUND, DRIVES, NO_NUMBER = range(3)
# status of a contact in a step: was slipping and goes on; was stuck; broke away; comes to rest; passes through zero
FREE, HELD, BROKEN, CAUGHT, PASSED = range(5)
# slots of the state: start of the step, end of the whole step, middle and end by two halves
HERE, WHOLE, MIDDLE, THERE = range(4)
# columns of the largest values of a part
POSITION, VELOCITY, LIMIT = range(3)
