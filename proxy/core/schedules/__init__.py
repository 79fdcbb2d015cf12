"""How streams generate: rhythms, their changes, bursts, and what specs say of them."""
