"""Who sticks, slips and opens at an instant, and what loops of redundant contacts share."""
