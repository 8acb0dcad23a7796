"""One implicit step: stages condensed to the contacts, its error, and what may end it."""
