"""Linkages as parts: settings, levels, links and pins, labels, coupon; bodies and free motion.

`settings.settings_for` and `links.detail_linkage` make the parts, `bodies.bodies` what they are for
collisions, `motion.free_motion` the range in which they move. Nothing is imported here, so that the
command line starts without arrays.
"""
