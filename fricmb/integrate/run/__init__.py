"""What goes on around the steps of any run: ending it, its memory, long runs in parts, arrays kept with a problem."""
