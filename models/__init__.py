"""Numpy models of the pipeline: the double-precision reference and the bit-accurate model of each core."""
