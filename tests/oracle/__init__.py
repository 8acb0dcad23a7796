"""An oracle for motion under dry friction: other equations of the same scenes, solved by scipy.

Nothing of ``fricmb.integrate``, ``fricmb.system`` or ``fricmb.plan`` is used: numbers go in, and what a law publishes
of itself (``define_force``, ``define_rate``, ``define_coefficient``).

``problem``   masses, springs, loads and contacts as numbers;  ``laws``  a law of the catalogue as numbers
``instant``   accelerations and modes together at one instant, by enumeration over convex problems
``motion``    forces and accelerations between transitions;  ``slow``  starts of slip in two directions
``run``       the loop: DOP853 (or Radau) from transition to transition
``judge``     the error of a run of fricmb over its tolerance and the growth of errors
``table``     every law, five situations;  ``random_scenes``  scenes from seeds;  ``known``  cells that still fail
``inputs``    fast and brief functions of time;  ``feet``, ``driven``, ``drives``, ``groups``  more kinds of scenes
``impacts``   scenes with impacts;  ``struck``, ``hits``, ``bounces``, ``struck_judge``  their program and judge
``machines``  several parts in a row
``units``     scenes in other units, and beside idle bodies;  ``drawn``  what draws them
"""
