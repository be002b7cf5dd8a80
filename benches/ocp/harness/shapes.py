"""Smooth motions from rest to rest along a straight line of joint space: first guesses and proofs of feasibility."""

import numpy


def cubic(s):
    """Value, first and second derivative; the least effort of a mass."""
    return 3 * s**2 - 2 * s**3, 6 * s - 6 * s**2, 6 - 12 * s


def ramps(share):
    """The rate rises to 1/(1 - share) as a half cosine over this share of the time, stays there, and falls alike: peak
    acceleration pi/2/(share (1 - share))."""

    def shape(s):
        s = numpy.asarray(s, dtype=float)
        top, omega = 1 / (1 - share), numpy.pi / share
        early, late = numpy.minimum(s, share), numpy.minimum(1 - s, share)
        way = lambda x: top / 2 * (x - numpy.sin(omega * x) / omega)
        speed = lambda x: top / 2 * (1 - numpy.cos(omega * x))
        bend = lambda x: top / 2 * omega * numpy.sin(omega * x)
        phases = lambda rising, steady, falling: numpy.where(s < share, rising, numpy.where(s > 1 - share, falling, steady))
        return (phases(way(early), top * (s - share / 2), 1 - way(late)), phases(speed(early), top, speed(late)),
                phases(bend(early), 0.0, -bend(late)))

    return shape


def motion(shape, start, end, duration, times):
    """q, v, a at times in parts of the duration."""
    value, rate, bend = (numpy.asarray(part)[:, None] for part in shape(numpy.asarray(times)))
    distance = numpy.asarray(end) - numpy.asarray(start)
    return start + value * distance, rate * distance / duration, bend * distance / duration**2


def bump(height, duration, times):
    """q, v, a of a detour 16 s^2 (1 - s)^2 of this height, which begins and ends at rest."""
    s = numpy.asarray(times)[:, None]
    height = numpy.atleast_1d(height)
    return (height * 16 * s**2 * (1 - s)**2, height * 32 * s * (1 - s) * (1 - 2 * s) / duration,
            height * 32 * (1 - 6 * s + 6 * s**2) / duration**2)
