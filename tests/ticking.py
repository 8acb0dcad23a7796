"""A number of slices that changes at every look, so that each slice ends as soon as it may."""

import threading
import time
from contextlib import contextmanager

from fricmb.integrate.run import slices


@contextmanager
def ticking():
    """Runs made inside come back to Python as often as they can."""
    done = threading.Event()

    def count():
        while not done.is_set():
            slices._ticks[0] += 1
            time.sleep(0.0)

    counter = threading.Thread(target=count)
    counter.start()
    try:
        yield
    finally:
        done.set()
        counter.join()
