"""The general methods: loops over steps, and the integrators made of them."""
