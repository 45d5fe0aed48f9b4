"""The product linkage: kinds of mechanism, levels, links, pins, labels, plates, schedules."""
