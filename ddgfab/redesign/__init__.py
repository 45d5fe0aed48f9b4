"""Nets whose edges run the wrong way: the surface moves a little, or the net is traced anew."""
