"""Smooth motions from rest to rest along a straight line of joint space: first guesses, and motions that prove tasks feasible."""

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
        up = top / 2 * (early - numpy.sin(omega * early) / omega)
        down = top / 2 * (late - numpy.sin(omega * late) / omega)
        rise, fall = s < share, s > 1 - share
        value = numpy.where(rise, up, numpy.where(fall, 1 - down, top * (s - share / 2)))
        rate = numpy.where(rise, top / 2 * (1 - numpy.cos(omega * early)), numpy.where(fall, top / 2 * (1 - numpy.cos(omega * late)), top))
        bend = numpy.where(rise, numpy.sin(omega * early), numpy.where(fall, -numpy.sin(omega * late), 0.0))
        return value, rate, top / 2 * omega * bend

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
