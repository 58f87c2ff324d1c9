"""The verbs of ``simulation_interfaces``: what the services of a port do."""
