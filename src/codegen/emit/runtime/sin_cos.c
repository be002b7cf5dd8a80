#include <stdint.h>
#include <string.h>

/* Sine and cosine to two units in the last place. */
static inline void sin_cos(double x, double *sine, double *cosine)
{
    static const double s[] = {
        1.0 / 6227020800.0, -1.0 / 39916800.0, 1.0 / 362880.0, -1.0 / 5040.0, 1.0 / 120.0, -1.0 / 6.0};
    static const double c[] = {
        -1.0 / 87178291200.0, 1.0 / 479001600.0, -1.0 / 3628800.0, 1.0 / 40320.0, -1.0 / 720.0, 1.0 / 24.0};
    double turns, k, r, z, p, t;
    uint64_t quarter, swap, sign, bits[2];
    if (!(fabs(x) < 1e5)) {
        *sine = sin(x);
        *cosine = cos(x);
        return;
    }
    /* k: the nearest multiple of pi/2; r: what is beyond it. */
    turns = x * 0.6366197723675814;
    quarter = (uint64_t)(int64_t)(turns + copysign(0.5, turns));
    k = (double)(int64_t)quarter;
    r = MUL_ADD(-k, 1.5707963267341256, x);
    r = MUL_ADD(-k, 6.077100506303966e-11, r);
    r = MUL_ADD(-k, 2.0222662487959506e-21, r);
    /* Taylor series, |r| <= pi/4: to r^15 and r^16. */
    z = r * r;
    p = -1.0 / 1307674368000.0;
    t = 1.0 / 20922789888000.0;
    for (int i = 0; i < 6; i++) {
        p = MUL_ADD(p, z, s[i]);
        t = MUL_ADD(t, z, c[i]);
    }
    p = MUL_ADD(r * z, p, r);
    t = MUL_ADD(z * z, t, MUL_ADD(-0.5, z, 1.0));
    memcpy(&bits[0], &p, sizeof p);
    memcpy(&bits[1], &t, sizeof t);
    swap = (bits[0] ^ bits[1]) & (0 - (quarter & 1));
    sign = (quarter & 2) << 62;
    bits[0] ^= swap ^ sign;
    sign = ((quarter + 1) & 2) << 62;
    bits[1] ^= swap ^ sign;
    memcpy(sine, &bits[0], sizeof p);
    memcpy(cosine, &bits[1], sizeof t);
}

