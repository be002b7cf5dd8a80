#include <stdint.h>
#include <string.h>

/* Sine and cosine to two units in the last place; see sin_cos_in_range in Rust, whose operations these are. */
static inline void sin_cos(double angle, double *sine, double *cosine)
{
    static const double s[] = {
        1.5896213900738097e-10, -2.5050747490622135e-8, 2.7557313619702316e-6,
        -0.00019841269829584855, 0.008333333333322113, -0.1666666666666663};
    static const double c[] = {
        -1.1358525208068056e-11, 2.0875700628463847e-9, -2.755731417776405e-7,
        2.4801587288846537e-5, -0.001388888888887305, 0.041666666666666595};
    double x, n, near, product, high, back, lost, rest, r, tail, z, half, above, below, p, t;
    uint64_t quarter, swap, negative, bits[2];
    x = fabs(angle);
    if (!(x < 1e6)) {
        *sine = sin(angle);
        *cosine = cos(angle);
        return;
    }
    /* n: the nearest multiple of pi/2; r + tail: the rest, exact to twice the digits. */
    quarter = (uint64_t)(x * 0.6366197723675814 + 0.5);
    n = (double)quarter;
    near = x - n * 1.5707963267341256;
    product = n * 6.077100506303966e-11;
    high = near - product;
    back = near - high;
    lost = (near - (high + back)) + (back - product);
    rest = lost - n * 2.0222662487959506e-21;
    r = high + rest;
    tail = (high - r) + rest;
    /* Polynomials in r^2, |r| <= pi/4. */
    z = r * r;
    half = z * 0.5;
    p = s[0];
    t = c[0];
    for (int i = 1; i < 6; i++) {
        p = MUL_ADD(p, z, s[i]);
        t = MUL_ADD(t, z, c[i]);
    }
    p = r + MUL_ADD(r * z, p, MUL_ADD(tail, -half, tail));
    above = 1.0 - half;
    below = (1.0 - above) - half;
    t = above + (below + MUL_ADD(z * z, t, -(r * tail)));
    /* n mod 4 = 0, 1, 2, 3: the sine is p, t, -p, -t, the cosine t, -p, -t, p. */
    memcpy(&negative, &angle, sizeof angle);
    memcpy(&bits[0], &p, sizeof p);
    memcpy(&bits[1], &t, sizeof t);
    swap = (bits[0] ^ bits[1]) & (0 - (quarter & 1));
    bits[0] ^= swap ^ ((quarter & 2) << 62) ^ (negative & ((uint64_t)1 << 63));
    bits[1] ^= swap ^ (((quarter + 1) & 2) << 62);
    memcpy(sine, &bits[0], sizeof p);
    memcpy(cosine, &bits[1], sizeof t);
}

